// SPDX-License-Identifier: Apache-2.0
// How many threads parallel loops may run on, and that these threads leave the application's signals alone.
//
// oneTBB starts its threads in the middle of a loop and fails badly if one cannot be started: the exception
// leaves a lock of oneTBB locked, and the next loop waits for it for ever. So as many threads are started here
// first. A thread inherits the signal mask of the thread that starts it, which in a loop may be any thread of
// the application. So oneTBB's threads are started here, with all signals blocked.
#pragma once

#include <tbb/global_control.h>

#include <optional>

namespace understudy::compositor {

/// During its lifetime, parallel loops of this process run on the calling thread alone if the threads that they
/// would use cannot be started (ulimit -u, ulimit -v, pids.max).
class WorkerThreads {
 public:
  WorkerThreads();

 private:
  std::optional<tbb::global_control> one_;
};

}  // namespace understudy::compositor
