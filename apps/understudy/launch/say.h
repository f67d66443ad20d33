// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "compositor/logging/log.h"

namespace understudy {

/// Prints a line for the user of a command.
inline void say(const std::string& line) {
  logging::log(logging::Level::info, "{}", line);
}

}  // namespace understudy
