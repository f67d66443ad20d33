// SPDX-License-Identifier: Apache-2.0
#include "compositor/service/worker_threads.h"

#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <latch>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

#include "compositor/logging/log.h"
#include "compositor/service/blocked_signals.h"

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

/// How long the threads of oneTBB are waited for, if other loops of the application keep them busy.
constexpr std::chrono::seconds start_patience{1};

/// Makes oneTBB start its threads with the calling thread's signal mask, by a loop in which each of `parallel`
/// threads waits for all others. oneTBB ends its threads with its last arena and thread, so the arena stays.
void start_threads(std::size_t parallel) {
  static constinit std::mutex starting;
  static constinit std::size_t started = 1;
  const std::scoped_lock one_at_a_time(starting);
  if (parallel <= started) return;
  const auto until = std::chrono::steady_clock::now() + start_patience;
  std::mutex mutex;
  std::condition_variable arrived;
  std::size_t there = 0;
  const auto wait_for_all = [&](std::size_t) {
    std::unique_lock lock(mutex);
    if (++there == parallel) arrived.notify_all();
    arrived.wait_until(lock, until, [&] { return there >= parallel; });
  };
  // Never destroyed: other threads may use oneTBB until the process ends.
  static auto* const kept = new std::vector<std::unique_ptr<tbb::task_arena>>;
  kept->push_back(std::make_unique<tbb::task_arena>(static_cast<int>(parallel)));
  kept->back()->execute(
      [&] { tbb::parallel_for(std::size_t(0), parallel, wait_for_all, tbb::simple_partitioner()); });
  started = parallel;
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
  const BlockedSignals blocked;
  if (can_start(parallel - 1)) {
    start_threads(parallel);
    return;
  }
  logging::log(logging::Level::warn,
               "{} threads cannot be started, so volumes are rendered on one; raise `ulimit -u` or `ulimit -v`",
               parallel - 1);
  one_.emplace(tbb::global_control::max_allowed_parallelism, 1);
}

}  // namespace understudy::compositor
