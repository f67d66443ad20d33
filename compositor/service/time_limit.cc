// SPDX-License-Identifier: Apache-2.0
#include "compositor/service/time_limit.h"

#include <tbb/task_group.h>

#include <condition_variable>
#include <mutex>
#include <thread>

#include "compositor/service/blocked_signals.h"

namespace understudy::compositor {

bool done_until(Deadline until, const std::function<void()>& work) {
  // Cancels the group in which `work` runs, together with the parallel loops that `work` begins.
  tbb::task_group_context context;
  std::mutex mutex;
  std::condition_variable_any ended;
  std::jthread clock;
  {
    const BlockedSignals blocked;
    clock = std::jthread([&](const std::stop_token& stop) {
      std::unique_lock lock(mutex);
      ended.wait_until(lock, stop, until, [] { return false; });
      if (!stop.stop_requested()) context.cancel_group_execution();
    });
  }
  // run_and_wait() resets the context's cancellation, so its result is what counts.
  const bool done = tbb::task_group(context).run_and_wait(work) != tbb::canceled;
  clock.request_stop();
  return done;
}

}  // namespace understudy::compositor
