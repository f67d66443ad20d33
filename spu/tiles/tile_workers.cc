// SPDX-License-Identifier: Apache-2.0
#include "spu/tiles/tile_workers.h"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <exception>
#include <utility>

#include "compositor/logging/log.h"
#include "compositor/service/limits.h"
#include "compositor/transport/socket.h"
#include "spu/remote/gl_server_protocol.h"
#include "spu/report/counters.h"

namespace understudy::spu {
namespace {

using compositor::Clock;
using compositor::MalformedMessage;
using compositor::Message;
namespace limits = compositor::limits;

/// Records are sent in portions, so that tile workers draw while the application still makes calls.
constexpr std::size_t many_words = 4096;

}  // namespace

std::vector<std::byte> encode(const TilePlace& place) {
  const std::array<std::uint64_t, 2> words = {std::uint64_t(place.part), std::uint64_t(place.parts)};
  const auto bytes = std::as_bytes(std::span(words));
  return {bytes.begin(), bytes.end()};
}

TilePlace decode_tile_place(std::span<const std::byte> payload) {
  std::array<std::uint64_t, 2> words{};
  if (payload.size() != sizeof words) throw MalformedMessage("its hello is no tile worker's");
  std::memcpy(words.data(), payload.data(), sizeof words);
  if (words[1] > most_tiles || words[0] == 0 || words[0] >= words[1])
    throw MalformedMessage("its hello names a tile that there is not");
  return {int(words[0]), int(words[1])};
}

void TileWorkers::gather(int parts) {
  if (std::exchange(gathered_, true)) return;
  try {
    for (int part = 1; part < parts; ++part) {
      const auto until = Clock::now() + limits::hello_patience;
      auto worker = std::make_unique<TileWorker>(
          TileWorker{compositor::Connection(compositor::connect_to(socket_, until), gl_server_protocols,
                                            limits::max_gl_server_message_bytes),
                     {}});
      worker->connection.send(compositor::LauncherMessage::hello_client, 0, encode(TilePlace{part, parts}),
                              until);
      workers_.push_back(std::move(worker));
    }
    // The tile workers start in parallel.
    for (const auto& worker : workers_) {
      const Message accepted = worker->connection.receive(Clock::now() + limits::server_patience);
      if (accepted.type == compositor::LauncherMessage::refused)
        throw std::runtime_error(compositor::decode_text(accepted.payload));
      if (accepted.type != compositor::LauncherMessage::accepted)
        throw MalformedMessage("its first message is no acceptance");
    }
    process_counters().tiles.count = std::uint32_t(parts);
  } catch (const std::exception& error) {
    workers_.clear();
    logging::log(logging::Level::warn, "GL server: windows are drawn by one process: no tile worker: {}",
                 error.what());
    give_up("a tile worker could not be had");
  }
}

void TileWorkers::send(TileWorker& worker, const Records& records, bool wants_answer) {
  const CallsHead head{0, wants_answer ? ServerReply::answer : ServerReply::none, records.words().size(),
                       records.payload().size()};
  worker.chunks.clear();
  worker.chunks.add(records.words(), records.payload());
  const std::uint64_t count = worker.chunks.heads().size();
  const std::array<compositor::Bytes, 4> parts = {
      std::as_bytes(std::span(&head, 1)), std::as_bytes(std::span(&count, 1)),
      std::as_bytes(worker.chunks.heads()), std::as_bytes(worker.chunks.data())};
  worker.connection.send(GlServerMessage::calls, 0, parts, limits::server_patience);
}

void TileWorkers::lose(const char* what) {
  workers_.clear();
  logging::log(logging::Level::warn,
               "GL server: windows are drawn by one process from here on: a tile worker {}", what);
  give_up("a tile worker was lost");
}

void TileWorkers::hand_on(bool now) {
  const std::size_t words = records_.words().size() + records_.payload().size();
  if (words == 0 || (!now && words < many_words)) return;
  try {
    for (const auto& worker : workers_) send(*worker, records_, false);
  } catch (const std::exception& error) {
    lose(error.what());
  }
  records_.clear();
}

void TileWorkers::ask(int index, const Records& records) {
  if (index >= count()) return;
  try {
    send(*workers_[std::size_t(index)], records, true);
  } catch (const std::exception& error) {
    lose(error.what());
  }
}

CallAnswer TileWorkers::answer(int index) {
  if (index >= count()) return {};
  try {
    const Message message =
        workers_[std::size_t(index)]->connection.receive(Clock::now() + limits::server_patience);
    auto answer = decode_answer(message.payload);
    if (message.type != GlServerMessage::answered || !answer) throw MalformedMessage("spoke out of turn");
    return std::move(*answer);
  } catch (const std::exception& error) {
    lose(error.what());
    return {};
  }
}

void TileWorkers::end_tiles() {
  --in_tiles_;
  let_go_if_unused();
}

void TileWorkers::give_up(const char* why) {
  if (given_up_ != nullptr) return;
  given_up_ = why;
  put_text(process_counters().tiles.given_up, why);
  let_go_if_unused();
}

/// Windows that are still divided depend on the tile workers.
void TileWorkers::let_go_if_unused() {
  if (in_tiles_ > 0 || given_up_ == nullptr) return;
  workers_.clear();
  records_.clear();
}

}  // namespace understudy::spu
