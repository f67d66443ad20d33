// SPDX-License-Identifier: Apache-2.0
// Log lines of Understudy's libraries and programs, on stderr: "understudy: what, where, what to do". A
// program's own output (that of `print`, a summary, a progress bar) is not written here.
#pragma once

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "compositor/logging/level.h"

namespace understudy::logging {

/// Whether lines of this level are written. UNDERSTUDY_LOG is read once.
bool is_written(Level level) noexcept;

/// Writes `text` as one line, after the program's name. Never throws: a line that cannot be written is lost.
void write(Level level, std::string_view text) noexcept;

/// Sets the name that lines begin with, "understudy" by default. The string must stay valid.
void set_program(const char* name) noexcept;

/// Formats and writes a line; costs only a comparison if the level is not written.
template <typename... Arguments>
void log(Level level, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  if (is_written(level)) write(level, fmt::format(format, std::forward<Arguments>(arguments)...));
}

}  // namespace understudy::logging
