// SPDX-License-Identifier: Apache-2.0
// Tells the launcher once a second that rank 0 is alive, and for how long it has worked on a request whose
// application has gone: rank 0 may then wait for something that never comes, as from a rank that was stopped or
// a host that was cut off, and cannot detect that itself. The launcher ends such a group
// (compositor/service/broker.h).
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "compositor/transport/connection.h"

namespace understudy::compositor {

class Heartbeat {
 public:
  /// Uses the connection to the launcher; no other code may send on it from now on. Throws std::system_error.
  explicit Heartbeat(const Connection& launcher);

  /// Begins a request of the application behind this socket, which stays open until end().
  void begin(int application);
  void end();

 private:
  void beat(const std::stop_token& stop);
  std::chrono::milliseconds unwanted_for();

  Connection launcher_;
  std::mutex mutex_;
  std::condition_variable_any woken_;
  int application_ = -1;                ///< of the current request; -1: there is none
  std::optional<Deadline> gone_since_;  ///< since when the application has been gone
  std::jthread thread_;
};

}  // namespace understudy::compositor
