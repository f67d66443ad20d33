#include "compositor/exchange/bells.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>

namespace understudy::compositor {
namespace {

// So long that a bell that is missed is noticed by whoever runs the tests.
constexpr std::chrono::seconds for_ever{600};

TEST(Bells, TwoProcessesWakeEachOtherAndMissNothing) {
  constexpr std::uint32_t turns = 20'000;
  const FileDescriptor memory = Bells::make_memory(2);
  const auto play = [&](int mine) {
    Bells bells(memory, 2, mine);
    for (std::uint32_t turn = 0; turn < turns; ++turn) {
      if (mine == 0) bells.ring(1);
      while (bells.rung() == turn) bells.sleep(turn, for_ever);
      if (mine == 1) bells.ring(0);
    }
    return bells.rung();
  };
  const pid_t other = ::fork();
  if (other == 0) std::_Exit(play(1) == turns ? 0 : 1);
  EXPECT_EQ(play(0), turns);
  int status = -1;
  ::waitpid(other, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST(Bells, WhatCameAfterTheLookIsNotSleptThrough) {
  const FileDescriptor memory = Bells::make_memory(3);
  Bells mine(memory, 3, 1), other(memory, 3, 2);
  const std::uint32_t rung = mine.rung();
  other.ring(1);
  mine.sleep(rung, for_ever);
  EXPECT_EQ(mine.rung(), rung + 1);
  EXPECT_EQ(other.rung(), 0u);
}

TEST(Bells, SleepEndsWithItsTime) {
  const FileDescriptor memory = Bells::make_memory(1);
  Bells bells(memory, 1, 0);
  bells.sleep(bells.rung(), std::chrono::microseconds(100));
  EXPECT_EQ(bells.rung(), 0u);
}

}  // namespace
}  // namespace understudy::compositor
