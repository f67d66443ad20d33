// SPDX-License-Identifier: Apache-2.0
// Restricts the system calls of a process that executes OpenGL calls for others, after its driver is open. All
// other calls fail with EPERM (open and similar calls with EACCES); only a call by the number of another
// architecture ends the process.
#pragma once

#include <string>

namespace understudy::launcher {

/// What draws. A driver on the CPU compiles shaders into memory and needs no file afterwards; drivers of
/// graphics cards send requests to their kernel module, and open devices later.
enum class Renderer { cpu, graphics_card };

/// Values other than `nothing` require that another mechanism restricts the files (file_restriction.h).
enum class Opening {
  nothing,
  to_write,  ///< files can be opened for writing, but not read-only
  all
};

struct SystemCalls {
  Renderer renderer = Renderer::cpu;
  Opening opening = Opening::nothing;
};

/// Applies to all threads of this process and those that they start, and is irreversible. Returns what prevents
/// this, or an empty string.
std::string restrict_system_calls(const SystemCalls& calls);

}  // namespace understudy::launcher
