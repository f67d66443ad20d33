// SPDX-License-Identifier: Apache-2.0
// Unix sockets by path.
#pragma once

#include <chrono>
#include <string>

#include "compositor/transport/file_descriptor.h"

namespace understudy::compositor {

using Clock = std::chrono::steady_clock;
using Deadline = Clock::time_point;

/// Waits until `fd` is ready for `events` (as in poll()); returns false if the deadline comes first.
bool wait_until_ready(int fd, short events, Deadline deadline);

/// Listens at `path`, with mode 0600 from the first moment. Replaces a socket file of this user at which nobody
/// listens any more. Throws std::runtime_error: what is wrong with the path, and what to do.
FileDescriptor listen_at(const std::string& path);

/// Returns the next connection, if there is one; those of other users are closed and skipped. If there is none,
/// errno has the reason, as after accept().
FileDescriptor accept_from(const FileDescriptor& listener);

/// Result of one attempt to connect: a socket, or errno's reason (EAGAIN: the listener's queue is full).
struct ConnectionAttempt {
  FileDescriptor socket;
  int error = 0;
};

/// Attempts once to connect from this process, without waiting. Throws std::runtime_error if `path` is invalid.
ConnectionAttempt attempt_to_connect(const std::string& path);

/// Connects; if this process may not make sockets, another one connects for it (connector.h). Throws
/// std::runtime_error, and ForeignListener (peer.h) if another user listens there.
FileDescriptor connect_to(const std::string& path, Deadline deadline);

}  // namespace understudy::compositor
