// SPDX-License-Identifier: Apache-2.0
// Connections for a process that may make no socket: another one, which is trusted, connects for it and passes
// the socket along a channel.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>

#include "compositor/transport/file_descriptor.h"
#include "compositor/transport/socket.h"

namespace understudy::compositor {

/// The two ends: of the process that connects, and of the one that asks. Throws std::runtime_error.
std::pair<FileDescriptor, FileDescriptor> connector_channel();

/// From now on connect_to() (socket.h) asks at the other end of `channel`, on every thread.
void connect_through(FileDescriptor channel);

/// One attempt by whoever is at the other end; empty where this process connects itself. An end that is gone,
/// or does not answer in time, is an error.
std::optional<ConnectionAttempt> ask_for_connection(const std::string& path, Deadline deadline);

/// Answers one question that waits in `channel`, if any does: an attempt, without waiting, to connect to a path
/// in `allowed`; EACCES for others, EINVAL where no attempt can be made. False when nobody is at the other end
/// any more.
bool answer_connector(const FileDescriptor& channel, std::span<const std::string> allowed);

}  // namespace understudy::compositor
