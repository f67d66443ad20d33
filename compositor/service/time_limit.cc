// SPDX-License-Identifier: Apache-2.0
#include "compositor/service/time_limit.h"

#include <tbb/task_group.h>

#include <condition_variable>
#include <mutex>
#include <thread>

namespace understudy::compositor {

bool done_until(Deadline until, const std::function<void()>& work) {
  // Parallel loops that `work` begins are cancelled with the group that it runs in.
  tbb::task_group_context context;
  std::mutex mutex;
  std::condition_variable_any ended;
  std::jthread clock([&](const std::stop_token& stop) {
    std::unique_lock lock(mutex);
    ended.wait_until(lock, stop, until, [] { return false; });
    if (!stop.stop_requested()) context.cancel_group_execution();
  });
  // The context forgets after this that it was cancelled.
  const bool done = tbb::task_group(context).run_and_wait(work) != tbb::canceled;
  clock.request_stop();
  return done;
}

}  // namespace understudy::compositor
