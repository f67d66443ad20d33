// SPDX-License-Identifier: Apache-2.0
#include "compositor/service/worker_threads.h"

#include <atomic>
#include <exception>
#include <latch>
#include <stdexcept>
#include <thread>
#include <vector>

#include "compositor/logging/log.h"

namespace understudy::compositor {
namespace {

/// Whether `count` more threads can run at once.
bool can_start(std::size_t count) {
  std::latch all_tried(1);
  std::vector<std::jthread> threads;
  try {
    threads.reserve(count);
    while (threads.size() < count) threads.emplace_back([&all_tried] { all_tried.wait(); });
  } catch (const std::exception&) {
    // Counted below.
  }
  all_tried.count_down();
  return threads.size() == count;
}

/// If oneTBB's first initialisation throws, the next call that needs one waits for it for ever: oneTBB is not
/// called again in this process.
constinit std::atomic<bool> initialisation_failed{false};

std::size_t allowed_parallelism() {
  if (initialisation_failed)
    throw std::runtime_error("oneTBB could not be started; raise the memory limit and start the program again");
  try {
    return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  } catch (...) {
    initialisation_failed = true;
    throw;
  }
}

}  // namespace

WorkerThreads::WorkerThreads() {
  const std::size_t parallel = allowed_parallelism();
  if (can_start(parallel - 1)) return;
  logging::log(logging::Level::warn,
               "{} threads cannot be started, so volumes are rendered on one; raise `ulimit -u` or `ulimit -v`",
               parallel - 1);
  one_.emplace(tbb::global_control::max_allowed_parallelism, 1);
}

}  // namespace understudy::compositor
