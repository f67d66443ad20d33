// SPDX-License-Identifier: Apache-2.0
// The one way in which Understudy's libraries and programs write about what they do: lines on stderr,
// "understudy: what, where, what to do". A program's own output (what `print` prints, a summary, a progress
// bar) does not go through here.
#pragma once

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "compositor/logging/level.h"

namespace understudy::logging {

/// Whether lines of this level are written. UNDERSTUDY_LOG is read once.
bool is_written(Level level) noexcept;

/// `text` as one line, after the program's name. Never throws: a line that cannot be written is lost.
void write(Level level, std::string_view text) noexcept;

/// A program's lines begin with "understudy" where it names no other; `name` must outlive it.
void set_program(const char* name) noexcept;

/// Formats and writes; costs a comparison where the level is not written.
template <typename... Arguments>
void log(Level level, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  if (is_written(level)) write(level, fmt::format(format, std::forward<Arguments>(arguments)...));
}

}  // namespace understudy::logging
