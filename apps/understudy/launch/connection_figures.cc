// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/launch/connection_figures.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>

#include "compositor/transport/tcp/tcp_socket.h"
#include "spu/report/keys.h"

namespace understudy::launcher {
namespace {

namespace key = spu::report_key;
using Json = nlohmann::ordered_json;
using compositor::TcpTraffic;

constexpr const char* extension = ".link";
constexpr std::array<const char*, compositor::codec_count> codec_names = {"none", "lz4", "zstd"};

Json json_of(const TcpTraffic& traffic) {
  Json blocks;
  for (std::size_t i = 0; i < codec_names.size(); ++i) blocks[codec_names[i]] = traffic.blocks[i].load();
  return {{key::messages, traffic.messages.load()},
          {key::payload_bytes, traffic.payload_bytes.load()},
          {key::bytes, traffic.bytes.load()},
          {key::blocks, blocks}};
}

/// Adds numbers, and objects member by member; other values stay unchanged.
void add(Json& sum, const Json& more) {
  for (const auto& [name, value] : more.items()) {
    if (!sum.contains(name))
      sum[name] = value;
    else if (value.is_object())
      add(sum[name], value);
    else if (value.is_number_integer())
      sum[name] = sum[name].get<std::uint64_t>() + value.get<std::uint64_t>();
  }
}

}  // namespace

void write_connection_figures(const std::filesystem::path& folder, const std::string& address,
                              const compositor::TcpConnection& connection) {
  const compositor::LineFigures line = compositor::line_figures(connection.fd());
  Json up = json_of(connection.sent());
  Json down = json_of(connection.received());
  down.erase(key::blocks);  // blocks are counted only by the end that compresses
  const Json figures = {{key::address, address},
                        {key::connections, 1},
                        {key::up, up},
                        {key::down, down},
                        {key::round_trip_ms, line.round_trip_ms},
                        {key::bytes_per_second_up, line.bytes_per_second}};
  std::ofstream(folder / (std::to_string(::getpid()) + extension)) << figures.dump();
}

Json connection_figures(const std::filesystem::path& folder) {
  Json sum;
  std::error_code unreadable;
  for (const auto& entry : std::filesystem::directory_iterator(folder, unreadable)) {
    if (entry.path().extension() != extension) continue;
    std::ifstream file(entry.path());
    const Json figures = Json::parse(file, nullptr, false);
    if (figures.is_object()) add(sum, figures);
  }
  return sum;
}

std::string connection_text(const Json& figures) {
  const auto megabytes = [&](const char* way, const char* what) {
    return figures.at(way).at(what).get<double>() / 1e6;
  };
  return fmt::format(
      "connection to {}: {:.3f} MB sent (for {:.3f} MB of messages), {:.3f} MB received (for {:.3f} MB), round "
      "trip {:.2f} ms",
      figures.at(key::address).get<std::string>(), megabytes(key::up, key::bytes),
      megabytes(key::up, key::payload_bytes), megabytes(key::down, key::bytes),
      megabytes(key::down, key::payload_bytes), figures.at(key::round_trip_ms).get<double>());
}

}  // namespace understudy::launcher
