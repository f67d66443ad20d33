// SPDX-License-Identifier: Apache-2.0
// The process that executes one client's calls, as seen by the listening GL server. It is started by exec, so
// that its addresses differ from those of other clients' processes, and makes no connections of its own.
#pragma once

#include <csignal>
#include <optional>
#include <span>
#include <string>

#include "apps/understudy/processes/child_process.h"
#include "apps/understudy/processes/installation.h"
#include "compositor/transport/file_descriptor.h"

namespace understudy::launcher {

class ClientProcess {
 public:
  /// Throws std::system_error or std::runtime_error if the process cannot be started.
  ClientProcess(const Installation& installation, const std::string& socket, compositor::FileDescriptor client,
                const Environment& environment);

  /// Descriptor to poll: readable when the process requests a connection. -1 when it makes no more requests.
  int channel() const { return channel_.get(); }
  /// Answers the process's request, if any, by connecting to one of the `allowed` paths.
  void connect_for_it(std::span<const std::string> allowed);
  /// Empty while the process runs.
  std::optional<Ending> poll_ending() { return process_->poll_ending(); }
  void kill() const { process_->signal(SIGKILL); }

 private:
  compositor::FileDescriptor channel_;
  std::optional<ChildProcess> process_;
};

/// Listens at a Unix socket until a signal requests the end, with a process for each client, at most
/// limits::max_clients at once. Throws std::runtime_error if it cannot listen.
void serve_clients(const std::string& socket);

}  // namespace understudy::launcher
