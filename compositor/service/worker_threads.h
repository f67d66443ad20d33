// SPDX-License-Identifier: Apache-2.0
// How many threads parallel loops may run on.
//
// oneTBB starts its threads in the midst of a loop and does not survive when one cannot be started: the
// exception leaves its own lock locked, and the next loop waits for it for ever. So as many are started here
// first.
#pragma once

#include <tbb/global_control.h>

#include <optional>

namespace understudy::compositor {

/// As long as it lives, parallel loops of this process run on the calling thread alone if the threads that they
/// would take cannot be started (ulimit -u, ulimit -v, pids.max).
class WorkerThreads {
 public:
  WorkerThreads();

 private:
  std::optional<tbb::global_control> one_;
};

}  // namespace understudy::compositor
