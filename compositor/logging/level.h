// SPDX-License-Identifier: Apache-2.0
// How much of what Understudy has to say is said: the environment's UNDERSTUDY_LOG. Needs no C++ library, for
// the entry library has none.
#pragma once

#include <stdlib.h>
#include <string.h>

namespace understudy::logging {

/// Each includes those after it: what a developer wants to see, what a user may want to know, what went another
/// way than was asked for, and what did not happen at all.
enum class Level { debug, info, warn, error };

constexpr const char* level_names[] = {"debug", "info", "warn", "error"};
constexpr Level usual_level = Level::info;

/// The level of that name, or `usual_level`; `known`, where given, becomes false where no level has the name.
inline Level level_named(const char* name, bool* known = nullptr) noexcept {
  for (int i = 0; i < 4; ++i)
    if (strcmp(name, level_names[i]) == 0) return static_cast<Level>(i);
  if (known != nullptr) *known = false;
  return usual_level;
}

/// The lowest level that is written, as UNDERSTUDY_LOG says.
inline Level lowest_level() noexcept {
  const char* name = ::secure_getenv("UNDERSTUDY_LOG");
  return name == nullptr || *name == '\0' ? usual_level : level_named(name);
}

}  // namespace understudy::logging
