// SPDX-License-Identifier: Apache-2.0
// What `understudy doctor` finds.
#pragma once

#include <string>

namespace understudy::launcher {

struct Finding {
  bool works = false;
  std::string what;  ///< what was found, or what is missing
};

struct NamedFinding {
  std::string name;
  Finding finding;
  std::string fix;  ///< what to do where it does not work
};

}  // namespace understudy::launcher
