// SPDX-License-Identifier: Apache-2.0
// Connections for a process that may not make sockets: another, trusted process connects for it and passes the
// socket along a channel.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>

#include "compositor/transport/file_descriptor.h"
#include "compositor/transport/socket.h"

namespace understudy::compositor {

/// Returns the two ends: of the process that connects, and of the one that asks. Throws std::runtime_error.
std::pair<FileDescriptor, FileDescriptor> connector_channel();

/// From now on connect_to() (socket.h) asks the process at the other end of `channel`, on every thread.
void connect_through(FileDescriptor channel);

/// Asks for one attempt by the process at the other end; null if this process connects itself. If the other end
/// has gone or does not answer in time, the attempt has an error.
std::optional<ConnectionAttempt> ask_for_connection(const std::string& path, Deadline deadline);

/// Answers one question that waits in `channel`, if there is one: attempts, without waiting, to connect to a
/// path in `allowed`; the error is EACCES for other paths, and EINVAL if no attempt can be made. Returns false
/// if the other end has gone.
bool answer_connector(const FileDescriptor& channel, std::span<const std::string> allowed);

}  // namespace understudy::compositor
