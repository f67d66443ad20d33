// SPDX-License-Identifier: Apache-2.0
// Starts a process for each client of a listening process, so that neither a crashing driver nor a closed
// connection affects other clients.
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
  /// Waits briefly for processes that are just ending; the others end with this process.
  ~ClientProcesses();

  /// Forks; the child runs `work`, whose result is its exit status, and ends. It gets SIGTERM when this process
  /// ends. Returns false if no process can be created.
  bool start(const std::function<int()>& work);
  /// Call when a child may have ended.
  void reap();
  std::size_t count() const { return processes_.size(); }

 private:
  std::set<pid_t> processes_;
};

/// Returns whether a signal requests the end; reaps processes that have ended.
bool asked_to_end(SignalInbox& inbox, ClientProcesses& clients);

/// Listens at a Unix socket until a signal requests the end, and runs `work` in a process for each client, at
/// most limits::max_clients at once. `who` names this process in messages about rejected clients. Throws
/// std::runtime_error if it cannot listen.
void listen_for_clients(const std::string& socket, const std::string& who,
                        const std::function<int(compositor::FileDescriptor)>& work);

}  // namespace understudy::launcher
