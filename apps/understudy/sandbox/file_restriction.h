// SPDX-License-Identifier: Apache-2.0
// Files that this process may use, by Landlock (Linux 5.13 and later): each call takes rights away and none
// gives any back. Holds for the calling thread and those that it starts.
#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace understudy::launcher {

/// What this kernel has; 0: nothing, or it is switched off.
int landlock_version();

/// Files are written, made, renamed and removed only below `folders`, and devices in /dev are written to. From
/// version 4 on no TCP port is opened or connected to; from version 6 on neither are abstract sockets of other
/// processes, nor are they sent signals. Returns what is in the way, or nothing.
std::string restrict_writing(std::span<const std::filesystem::path> folders);

/// Files are read, listed and executed only below `folders`. Returns what is in the way, or nothing.
std::string restrict_reading(std::span<const std::filesystem::path> folders);

}  // namespace understudy::launcher
