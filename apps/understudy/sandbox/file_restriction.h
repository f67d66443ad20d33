// SPDX-License-Identifier: Apache-2.0
// Restricts the files that this process may use, by Landlock (Linux 5.13 and later): each call
// removes rights, and none restores them. Applies to the calling thread and the threads that it
// starts, not to other existing threads.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace understudy::launcher {

/// Returns the version of Landlock in this kernel; 0: none, or disabled.
int landlock_version();

/// Folders with everything below them, and files. Missing ones are ignored.
struct UsableFiles {
  std::vector<std::filesystem::path> read;     ///< read, listed and executed
  std::vector<std::filesystem::path> written;  ///< the same, and written, created, renamed and removed
  std::vector<std::filesystem::path> devices;  ///< read, listed and written
};

/// Forbids the use of all other files from now on. Since version 4 also forbids binding and connecting TCP
/// ports; since version 6, connecting to abstract sockets of other processes and sending them signals. Returns
/// what prevents this, or an empty string.
std::string restrict_files(const UsableFiles& files);

}  // namespace understudy::launcher
