// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/processes/origin.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "apps/understudy/processes/build.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::launcher {
namespace {

using Json = nlohmann::ordered_json;

Json own_command() {
  Json words = Json::array();
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  for (std::string word; std::getline(file, word, '\0');) words.push_back(word);
  return words;
}

/// Returns the kernel's name of the processor; empty if there is none.
std::string processor_name() {
  constexpr std::string_view key = "model name";
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with(key) && colon != std::string::npos) return line.substr(colon + 2);
  }
  return {};
}

Json machine() {
  utsname name{};
  uname(&name);
  const long pages = sysconf(_SC_PHYS_PAGES);
  return {{"name", std::string(name.nodename)},
          {"processor", processor_name()},
          {"processors", std::thread::hardware_concurrency()},
          {"memory_bytes", std::uint64_t(pages) * std::uint64_t(sysconf(_SC_PAGESIZE))}};
}

}  // namespace

Json origin() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return {{"version", version_number()},
          {"commit", commit()},
          {"compiler", compiler()},
          {"instruction_set", volume::instruction_set()},
          {"command", own_command()},
          {"machine", machine()},
          {"time", fmt::format("{:%FT%TZ}", fmt::gmtime(now))}};
}

}  // namespace understudy::launcher
