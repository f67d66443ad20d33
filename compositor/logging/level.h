// SPDX-License-Identifier: Apache-2.0
// The lowest level of the log lines that are written: the environment's UNDERSTUDY_LOG. Uses no C++ library,
// because the entry library has none.
#pragma once

#include <stdlib.h>
#include <string.h>

namespace understudy::logging {

/// Each includes those after it: what a developer wants to see, what a user may want to know, what is done in
/// another way than was asked for, and what is not done at all.
enum class Level { debug, info, warn, error };

constexpr const char* level_names[] = {"debug", "info", "warn", "error"};
constexpr Level usual_level = Level::info;

/// Returns the level of that name. If there is none, returns `usual_level` and sets `*known` to false.
inline Level level_named(const char* name, bool* known = nullptr) noexcept {
  for (int i = 0; i < 4; ++i)
    if (strcmp(name, level_names[i]) == 0) return static_cast<Level>(i);
  if (known != nullptr) *known = false;
  return usual_level;
}

/// Returns the lowest level that is written, according to UNDERSTUDY_LOG.
inline Level lowest_level() noexcept {
  const char* name = ::secure_getenv("UNDERSTUDY_LOG");
  return name == nullptr || *name == '\0' ? usual_level : level_named(name);
}

}  // namespace understudy::logging
