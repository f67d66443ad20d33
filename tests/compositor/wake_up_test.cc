// SPDX-License-Identifier: Apache-2.0
#include "compositor/exchange/wake_up.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>

namespace understudy::compositor {
namespace {

// So long that a missed notification is noticed by whoever runs the tests.
constexpr std::chrono::seconds for_ever{600};

TEST(WakeUp, TwoProcessesWakeEachOtherAndMissNothing) {
  constexpr std::uint32_t turns = 20'000;
  const FileDescriptor memory = WakeUp::make_memory(2);
  const auto play = [&](int mine) {
    WakeUp wake_ups(memory, 2, mine);
    for (std::uint32_t turn = 0; turn < turns; ++turn) {
      if (mine == 0) wake_ups.notify(1);
      while (wake_ups.notified() == turn) wake_ups.sleep(turn, for_ever);
      if (mine == 1) wake_ups.notify(0);
    }
    return wake_ups.notified();
  };
  const pid_t other = ::fork();
  if (other == 0) std::_Exit(play(1) == turns ? 0 : 1);
  EXPECT_EQ(play(0), turns);
  int status = -1;
  ::waitpid(other, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST(WakeUp, WhatCameAfterTheLookIsNotSleptThrough) {
  const FileDescriptor memory = WakeUp::make_memory(3);
  WakeUp mine(memory, 3, 1), other(memory, 3, 2);
  const std::uint32_t notified = mine.notified();
  other.notify(1);
  mine.sleep(notified, for_ever);
  EXPECT_EQ(mine.notified(), notified + 1);
  EXPECT_EQ(other.notified(), 0u);
}

TEST(WakeUp, SleepEndsWithItsTime) {
  const FileDescriptor memory = WakeUp::make_memory(1);
  WakeUp wake_ups(memory, 1, 0);
  wake_ups.sleep(wake_ups.notified(), std::chrono::microseconds(100));
  EXPECT_EQ(wake_ups.notified(), 0u);
}

}  // namespace
}  // namespace understudy::compositor
