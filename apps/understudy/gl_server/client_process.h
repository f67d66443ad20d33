// SPDX-License-Identifier: Apache-2.0
// The process that makes one client's calls, seen from the GL server that listens. It is executed anew, so that
// its addresses differ from those of other clients' processes, and makes no connections of its own.
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
  /// Throws std::system_error, and std::runtime_error, where there can be no process.
  ClientProcess(const Installation& installation, const std::string& socket, compositor::FileDescriptor client,
                const Environment& environment);

  /// To be polled: it asks for a connection. -1 once it does not any more.
  int channel() const { return channel_.get(); }
  /// Connects for it, if it asks, to one of these paths.
  void connect_for_it(std::span<const std::string> allowed);
  /// Empty while it runs.
  std::optional<Ending> poll_ending() { return process_->poll_ending(); }
  void kill() const { process_->signal(SIGKILL); }

 private:
  compositor::FileDescriptor channel_;
  std::optional<ChildProcess> process_;
};

/// Listens at a Unix socket until a signal asks for the end, with a process for each client, at most
/// limits::max_clients at once. Throws std::runtime_error where nobody can listen.
void serve_clients(const std::string& socket);

}  // namespace understudy::launcher
