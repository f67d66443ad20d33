// SPDX-License-Identifier: Apache-2.0
// Rank 0's word to the launcher, once a second, that it lives, and for how long it has been at a request whose
// application has gone: what rank 0 waits for then may never come, as from a rank that was stopped or a host
// that was cut off, and it cannot tell itself. The launcher ends such a group (compositor/service/broker.h).
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
  /// Over the connection to the launcher, on which nobody else may send from now on. Throws std::system_error.
  explicit Heartbeat(const Connection& launcher);

  /// A request of the application behind this socket is in hand, which stays open until end().
  void begin(int application);
  void end();

 private:
  void beat(const std::stop_token& stop);
  std::chrono::milliseconds unwanted_for();

  Connection launcher_;
  std::mutex mutex_;
  std::condition_variable_any woken_;
  int application_ = -1;                ///< of the request in hand; -1: none is
  std::optional<Deadline> gone_since_;  ///< that application
  std::jthread thread_;
};

}  // namespace understudy::compositor
