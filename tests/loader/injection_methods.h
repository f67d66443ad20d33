// SPDX-License-Identifier: Apache-2.0
// The three injection methods, as a user selects them.
#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace understudy::testing {

enum class InjectionMethod { none, preload, folder, audit };

inline const char* name_of(InjectionMethod injection) {
  switch (injection) {
    case InjectionMethod::none:
      return "bare";
    case InjectionMethod::preload:
      return "preload";
    case InjectionMethod::folder:
      return "folder";
    case InjectionMethod::audit:
      return "audit";
  }
  return "?";
}

inline void PrintTo(InjectionMethod injection, std::ostream* out) {
  *out << name_of(injection);
}

inline std::vector<std::string> environment_of(InjectionMethod injection) {
  const std::string folder = ENTRY_FOLDER;
  switch (injection) {
    case InjectionMethod::none:
      return {};
    case InjectionMethod::preload:
      return {"LD_PRELOAD=" + folder + "/libunderstudy.so"};
    case InjectionMethod::folder:
      return {"LD_LIBRARY_PATH=" + folder + "/entry"};
    case InjectionMethod::audit:
      return {"LD_AUDIT=" + folder + "/libunderstudy-audit.so"};
  }
  return {};
}

}  // namespace understudy::testing
