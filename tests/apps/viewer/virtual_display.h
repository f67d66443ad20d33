// SPDX-License-Identifier: Apache-2.0
// An X server without a screen (Xvfb), for tests of the window.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

namespace viewer_test {

class VirtualDisplay {
 public:
  /// Starts Xvfb on a display number that Xvfb chooses, without the X extension `without` if that is not empty.
  /// Returns nullopt if Xvfb is not installed.
  static std::optional<VirtualDisplay> start(std::string without = "");
  VirtualDisplay(VirtualDisplay&& other) noexcept;
  VirtualDisplay& operator=(VirtualDisplay&&) = delete;
  ~VirtualDisplay();

  /// Value for the environment variable DISPLAY.
  const std::string& name() const { return name_; }

 private:
  VirtualDisplay(pid_t server, std::string name) : server_(server), name_(std::move(name)) {}

  pid_t server_;
  std::string name_;
};

}  // namespace viewer_test
