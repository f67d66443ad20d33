// SPDX-License-Identifier: Apache-2.0
// Which system calls a process that executes OpenGL calls for others may make once its driver is open. All
// others fail with EPERM (open and its kin with EACCES); only a call by the numbers of another architecture
// ends the process.
#pragma once

#include <string>

namespace understudy::launcher {

/// What draws: a driver on the CPU compiles shaders into memory and needs no file afterwards; drivers of
/// graphics cards ask their kernel module for everything, and open devices later.
enum class Renderer { cpu, graphics_card };

/// More than nothing is for where something else says which files (see file_restriction.h).
enum class Opening {
  nothing,
  to_write,  ///< files that are opened cannot be read alone
  all
};

struct SystemCalls {
  Renderer renderer = Renderer::cpu;
  Opening opening = Opening::nothing;
};

/// Holds for all threads of this process and those that they start, and cannot be taken back. Returns what is
/// in the way, or nothing.
std::string restrict_system_calls(const SystemCalls& calls);

}  // namespace understudy::launcher
