// SPDX-License-Identifier: Apache-2.0
// The findings of `understudy doctor`.
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
  std::string fix;  ///< what to do if it does not work
};

}  // namespace understudy::launcher
