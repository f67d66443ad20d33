// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "compositor/logging/log.h"

namespace understudy {

/// A line for the user who watches a command start.
inline void say(const std::string& line) {
  logging::log(logging::Level::info, "{}", line);
}

}  // namespace understudy
