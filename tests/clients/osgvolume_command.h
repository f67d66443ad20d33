// SPDX-License-Identifier: Apache-2.0
// The osgvolume command for the engine.
#pragma once

#include <map>
#include <string>

#include "tests/clients/command_test.h"

namespace clients {

/// Fixed-function technique, raw bytes.
inline Words osgvolume() {
  return {"osgvolume",
          "--no-shader",
          "--replace-alpha-with-luminance",
          "--raw",
          "256",
          "256",
          "110",
          "1",
          "1",
          "little",
          engine_file().string()};
}

/// A window of 512 x 512 at the display's corner.
inline std::map<std::string, std::string> osgvolume_environment(const std::string& display) {
  return {{"DISPLAY", display}, {"OSG_WINDOW", "0 0 512 512"}, {"OSG_THREADING", "SingleThreaded"}};
}

}  // namespace clients
