// SPDX-License-Identifier: Apache-2.0
// The sandbox of a process that executes OpenGL calls for others: a stream that exploits a fault of a driver
// must not gain access to files, programs or networks.
//
// It closes in two steps. A driver has to open files and devices. So in the first step, while there is only one
// thread and no call has been read, resources are limited and files that no driver needs are forbidden. After
// the driver has created a context, seccomp removes what it does not need to draw, from its threads, too.
// Landlock does not affect existing threads, so its rules must be set in the first step.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/understudy/sandbox/system_call_filter.h"

namespace understudy::launcher {

/// What a sandboxed process uses in addition to devices, and to the standard folders of libraries and settings.
struct SandboxFolders {
  std::vector<std::filesystem::path> written;
  std::vector<std::filesystem::path> libraries;  ///< folders and files
};

/// The state of a sandbox.
struct SandboxState {
  std::string obstacle;  ///< why system calls are not restricted; empty: they are restricted
  int landlock = 0;      ///< version in effect; 0: none
  /// Why Landlock is not in effect; empty: it is. Without Landlock, no file can be opened, neither in the
  /// folders to be written nor by the driver of a graphics card.
  std::string no_landlock;
};

class Sandbox {
 public:
  /// The first step: resource limits, no new privileges, and access to files only in `folders` and where
  /// drivers have theirs. To be called before the process has a second thread.
  explicit Sandbox(const SandboxFolders& folders);

  /// The second step, which is irreversible. Open files stay open. If Landlock is in effect, files allowed by
  /// the first step can still be opened: for writing, if there are folders to be written, and by the driver of
  /// a graphics card also for reading.
  SandboxState close(Renderer renderer) const;

  /// Whether there are folders to be written.
  bool writes() const { return writes_; }

 private:
  bool writes_;
  std::string no_landlock_;
};

/// Detects the renderer from the driver's GL_RENDERER.
Renderer renderer_named(const std::string& name);

}  // namespace understudy::launcher
