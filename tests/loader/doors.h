// The three doors, as a user opens them.
#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace understudy::testing {

enum class Door { none, preload, folder, audit };

inline const char* name_of(Door door) {
  switch (door) {
    case Door::none:
      return "bare";
    case Door::preload:
      return "preload";
    case Door::folder:
      return "folder";
    case Door::audit:
      return "audit";
  }
  return "?";
}

inline void PrintTo(Door door, std::ostream* out) {
  *out << name_of(door);
}

inline std::vector<std::string> environment_of(Door door) {
  const std::string folder = DOOR_FOLDER;
  switch (door) {
    case Door::none:
      return {};
    case Door::preload:
      return {"LD_PRELOAD=" + folder + "/libunderstudy.so"};
    case Door::folder:
      return {"LD_LIBRARY_PATH=" + folder + "/door"};
    case Door::audit:
      return {"LD_AUDIT=" + folder + "/libunderstudy-audit.so"};
  }
  return {};
}

}  // namespace understudy::testing
