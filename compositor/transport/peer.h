// SPDX-License-Identifier: Apache-2.0
// Who is at the other end of a Unix socket. A path in a folder that others may write into says nothing about
// who listens there, so both ends ask the kernel (SO_PEERCRED).
#pragma once

#include <sys/types.h>

#include <stdexcept>
#include <string>

namespace understudy::compositor {

/// Another user listens at the path that was given.
class ForeignListener : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The user who listens, or who connected. Throws std::runtime_error.
uid_t peer_user(int socket);

/// Of a connection that was accepted: whether it comes from this process's user.
bool is_of_same_user(int socket);

/// Of a connection to `path`: throws ForeignListener when its listener is not of user `wanted`.
void require_listener_of(uid_t wanted, int socket, const std::string& path);

}  // namespace understudy::compositor
