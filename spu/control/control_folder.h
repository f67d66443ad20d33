// SPDX-License-Identifier: Apache-2.0
// The folder of the sockets at which this user's viewers can be controlled: one socket for each process, named
// by its id. Nobody else may look into it.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <vector>

namespace understudy::spu {

/// Returns $XDG_RUNTIME_DIR/understudy if that variable names a private folder, otherwise /tmp/understudy-UID.
/// The folder need not exist.
std::filesystem::path control_folder();

/// Throws std::runtime_error unless `folder` is a folder itself, not a link to one, belongs to this user, and
/// has mode 0700.
void require_control_folder(const std::filesystem::path& folder);

/// Creates the folder if it is missing, and requires what require_control_folder() does.
void make_control_folder(const std::filesystem::path& folder);

std::filesystem::path control_socket(const std::filesystem::path& folder, pid_t process);

struct ControlSocket {
  pid_t process = 0;
  std::filesystem::path path;
};

/// The sockets in the folder, by process id; none if there is no folder. Throws as require_control_folder().
std::vector<ControlSocket> control_sockets(const std::filesystem::path& folder);

/// Removes sockets at which nobody listens any more (their processes were killed), and the folder if it is
/// empty then. Does nothing to a folder that is not as required.
void remove_dead_control_sockets(const std::filesystem::path& folder) noexcept;

}  // namespace understudy::spu
