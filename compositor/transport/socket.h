// SPDX-License-Identifier: Apache-2.0
// Unix sockets by path.
#pragma once

#include <chrono>
#include <string>

#include "compositor/transport/file_descriptor.h"

namespace understudy::compositor {

using Clock = std::chrono::steady_clock;
using Deadline = Clock::time_point;

/// Waits until `fd` is ready for `events` (as in poll); false when the deadline came first.
bool wait_until_ready(int fd, short events, Deadline deadline);

/// Listens at `path`, with mode 0600 from the first moment. This user's socket file that nobody listens at any
/// more is replaced. Throws std::runtime_error: what is wrong with the path, and what to do.
FileDescriptor listen_at(const std::string& path);

/// The next connection, if there is one; those of other users are closed, and none of theirs is returned.
/// Without one errno says why, as accept() does.
FileDescriptor accept_from(const FileDescriptor& listener);

/// What came of one attempt to connect: a socket, or errno's reason (EAGAIN: the listener's queue is full).
struct ConnectionAttempt {
  FileDescriptor socket;
  int error = 0;
};

/// One attempt, without waiting, by this process. Throws std::runtime_error for what cannot name a socket.
ConnectionAttempt attempt_to_connect(const std::string& path);

/// Where this process may make no socket, another one connects for it (connector.h). Throws std::runtime_error,
/// and ForeignListener (peer.h) when another user listens there.
FileDescriptor connect_to(const std::string& path, Deadline deadline);

}  // namespace understudy::compositor
