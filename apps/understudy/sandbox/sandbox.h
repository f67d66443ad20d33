// SPDX-License-Identifier: Apache-2.0
// The sandbox of a process that executes OpenGL calls for others: a stream that finds a fault in a driver must
// not get at files, programs or networks by it.
//
// It closes in two steps. A driver needs files and devices to be opened, so at first, while there is one thread
// and no call was read, only resources are bounded and writing is taken away. Once the driver has made a
// context, seccomp takes away what a driver does not need to draw, from its threads too.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/understudy/sandbox/system_call_filter.h"

namespace understudy::launcher {

/// What holds of a sandbox.
struct SandboxState {
  std::string obstacle;  ///< why system calls are not restricted; empty: they are
  int landlock = 0;      ///< version in effect; 0: none
};

class Sandbox {
 public:
  /// The first step: bounds of resources, no new privileges, and files are changed only in `written`, which are
  /// folders. To be called before the process has a second thread.
  explicit Sandbox(std::vector<std::filesystem::path> written);

  /// The second step, for good. Files stay open. Where there are folders to be written, files can be opened in
  /// them; a graphics card's driver can open devices and what is below /usr, /etc, /proc and /sys, if Landlock
  /// bounds it to that.
  SandboxState close(Renderer renderer) const;

 private:
  std::vector<std::filesystem::path> written_;
  int landlock_ = 0;
};

/// By what the driver says of itself (GL_RENDERER).
Renderer renderer_named(const std::string& name);

}  // namespace understudy::launcher
