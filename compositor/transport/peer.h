// SPDX-License-Identifier: Apache-2.0
// Which user is at the other end of a Unix socket. A path in a folder that others may write into does not show
// who listens there, so both ends ask the kernel (SO_PEERCRED).
#pragma once

#include <sys/types.h>

#include <stdexcept>
#include <string>

namespace understudy::compositor {

/// Another user listens at the given path.
class ForeignListener : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Returns the user who listens, or who connected. Throws std::runtime_error.
uid_t peer_user(int socket);

/// Whether an accepted connection comes from this process's user.
bool is_of_same_user(int socket);

/// Throws ForeignListener if the listener of a connection to `path` does not belong to user `wanted`.
void require_listener_of(uid_t wanted, int socket, const std::string& path);

}  // namespace understudy::compositor
