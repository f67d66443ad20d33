// SPDX-License-Identifier: Apache-2.0
// A process for each client of one that listens: neither a driver's faults nor a closed connection concern
// another client.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <functional>
#include <set>
#include <string>

#include "apps/understudy/processes/signal_inbox.h"
#include "compositor/service/limits.h"
#include "compositor/transport/file_descriptor.h"

namespace understudy::launcher {

class ClientProcesses {
 public:
  ClientProcesses() = default;
  ClientProcesses(const ClientProcesses&) = delete;
  ClientProcesses& operator=(const ClientProcesses&) = delete;
  /// Waits a moment for those that have just ended; the others go with this process.
  ~ClientProcesses();

  /// Forks; the child does `work`, which gives its exit status, and ends. It gets SIGTERM when this process
  /// ends. False where no process can be made.
  bool start(const std::function<int()>& work);
  /// Call when a child may have ended.
  void reap();
  std::size_t count() const { return processes_.size(); }

 private:
  std::set<pid_t> processes_;
};

/// Whether a signal asks for the end; processes that have ended are reaped.
bool asked_to_end(SignalInbox& inbox, ClientProcesses& clients);

/// Listens at a Unix socket until a signal asks for the end, and has a process do `work` for each client, at
/// most limits::max_clients at once. `who` says so where there are more. Throws std::runtime_error where nobody
/// can listen.
void listen_for_clients(const std::string& socket, const std::string& who,
                        const std::function<int(compositor::FileDescriptor)>& work);

}  // namespace understudy::launcher
