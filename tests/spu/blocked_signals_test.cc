// SPDX-License-Identifier: Apache-2.0
// Threads of Understudy never run the application's signal handlers.
#include "compositor/service/blocked_signals.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "compositor/service/worker_threads.h"

namespace understudy::compositor {
namespace {

bool blocks(int signal) {
  sigset_t blocked;
  pthread_sigmask(SIG_BLOCK, nullptr, &blocked);
  return sigismember(&blocked, signal) != 0;
}

TEST(BlockedSignals, AreBlockedInThreadsThatAreStartedMeanwhile) {
  bool in_thread = false;
  bool fault = true;
  {
    const BlockedSignals blocked;
    std::thread([&] {
      in_thread = blocks(SIGUSR1) && blocks(SIGTERM);
      fault = blocks(SIGSEGV);
    }).join();
    EXPECT_TRUE(blocks(SIGUSR1));
  }
  EXPECT_TRUE(in_thread);
  EXPECT_FALSE(fault) << "the application's handler reports it";
  EXPECT_FALSE(blocks(SIGUSR1));
}

TEST(WorkerThreadsOfAViewer, BlockItsSignals) {
  const tbb::global_control four(tbb::global_control::max_allowed_parallelism, 4);
  const WorkerThreads threads;
  const auto caller = std::this_thread::get_id();
  std::atomic<int> unblocked = 0;
  tbb::parallel_for(0, 64, [&](int) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));  // so that the workers come
    if (std::this_thread::get_id() != caller && !blocks(SIGUSR1)) ++unblocked;
  });
  EXPECT_EQ(unblocked, 0);
  EXPECT_FALSE(blocks(SIGUSR1)) << "the viewer's thread";
}

}  // namespace
}  // namespace understudy::compositor
