// SPDX-License-Identifier: Apache-2.0
#include "compositor/logging/log.h"

#include <atomic>
#include <cstdio>
#include <iterator>

namespace understudy::logging {
namespace {

constinit std::atomic<const char*> program{"understudy"};

void write_line(std::string_view line) {
  // In one call, so that lines of several threads and processes do not mix.
  std::fwrite(line.data(), 1, line.size(), stderr);
}

/// Lines up to this length are formatted without allocating memory.
constexpr std::size_t usual_length = 1024;

Level level_of_environment() noexcept {
  const char* name = ::secure_getenv("UNDERSTUDY_LOG");
  if (name == nullptr || *name == '\0') return usual_level;
  bool known = true;
  const Level level = level_named(name, &known);
  if (!known)
    std::fprintf(stderr, "%s: UNDERSTUDY_LOG=%s is none of debug, info, warn and error; using %s\n",
                 program.load(), name, level_names[int(usual_level)]);
  return level;
}

}  // namespace

bool is_written(Level level) noexcept {
  static const Level lowest = level_of_environment();
  return level >= lowest;
}

void write(Level level, std::string_view text) noexcept {
  if (!is_written(level)) return;
  try {
    fmt::basic_memory_buffer<char, usual_length> line;
    fmt::format_to(std::back_inserter(line), "{}: {}{}\n", program.load(),
                   level == Level::debug ? "debug: " : "", text);
    write_line({line.data(), line.size()});
  } catch (const std::exception&) {
    // No memory for the line.
  }
}

void set_program(const char* name) noexcept {
  program = name;
}

}  // namespace understudy::logging
