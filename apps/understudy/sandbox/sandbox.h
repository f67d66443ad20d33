// SPDX-License-Identifier: Apache-2.0
// The sandbox of a process that executes OpenGL calls for others: a stream that finds a fault in a driver must
// not get at files, programs or networks by it.
//
// It closes in two steps. A driver needs files and devices to be opened, so at first, while there is one thread
// and no call was read, resources are bounded, and files are taken away that no driver needs. Once the driver
// has made a context, seccomp takes away what a driver does not need to draw, from its threads too. Landlock
// binds no thread that is there already: what it is to bind has to stand in the first step.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/understudy/sandbox/system_call_filter.h"

namespace understudy::launcher {

/// What a sandboxed process uses beyond devices, and libraries and settings where systems have them.
struct SandboxFolders {
  std::vector<std::filesystem::path> written;
  std::vector<std::filesystem::path> libraries;  ///< folders and files
};

/// What holds of a sandbox.
struct SandboxState {
  std::string obstacle;  ///< why system calls are not restricted; empty: they are
  int landlock = 0;      ///< version in effect; 0: none
  /// Why Landlock is not in effect; empty: it is. No file can be opened then, neither in the folders to be
  /// written nor by the driver of a graphics card.
  std::string no_landlock;
};

class Sandbox {
 public:
  /// The first step: bounds of resources, no new privileges, and files only in `folders` and where drivers have
  /// theirs. To be called before the process has a second thread.
  explicit Sandbox(const SandboxFolders& folders);

  /// The second step, for good. Files stay open. Where Landlock bounds it to what the first step left, files
  /// can be opened to be written, if there are folders for that, and by a graphics card's driver also to be
  /// read.
  SandboxState close(Renderer renderer) const;

  /// There are folders to be written.
  bool writes() const { return writes_; }

 private:
  bool writes_;
  std::string no_landlock_;
};

/// By what the driver says of itself (GL_RENDERER).
Renderer renderer_named(const std::string& name);

}  // namespace understudy::launcher
