// SPDX-License-Identifier: Apache-2.0
// Files that this process may use, by Landlock (Linux 5.13 and later): each call takes rights away and none
// gives any back. Holds for the calling thread and those that it starts, and not for others that are there.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace understudy::launcher {

/// What this kernel has; 0: nothing, or it is switched off.
int landlock_version();

/// Folders, with all below them, and files. One that is not there is left out.
struct UsableFiles {
  std::vector<std::filesystem::path> read;     ///< read, listed and executed
  std::vector<std::filesystem::path> written;  ///< that, and written, made, renamed and removed
  std::vector<std::filesystem::path> devices;  ///< read, listed and written
};

/// No other file is used from now on. From version 4 on no TCP port is opened or connected to; from version 6
/// on neither are abstract sockets of other processes, nor are they sent signals. Returns what is in the way,
/// or nothing.
std::string restrict_files(const UsableFiles& files);

}  // namespace understudy::launcher
