// SPDX-License-Identifier: Apache-2.0
// The application draws where that is faster.
#include "spu/volume/timing/speed_guard.h"

#include <gtest/gtest.h>

namespace understudy::spu {
namespace {

using namespace std::chrono_literals;

constexpr SpeedGuard::Clock::time_point start{1h};

/// Substitutes 20 runs a second for `seconds`; returns when that ended.
SpeedGuard::Clock::time_point substitute(SpeedGuard& guard, double ours_ms, double native_ms, int seconds,
                                         SpeedGuard::Clock::time_point now = start) {
  for (int run = 0; run < 20 * seconds && guard.reason(now).empty(); ++run) {
    guard.substituted(ours_ms, native_ms, now);
    now += 50ms;
  }
  return now;
}

TEST(SpeedGuard, SubstitutesWhatIsFaster) {
  SpeedGuard guard;
  const auto now = substitute(guard, 10, 30, 10);
  EXPECT_EQ(guard.reason(now), "");
}

TEST(SpeedGuard, LeavesWhatIsSlowerAfterASecond) {
  SpeedGuard guard;
  const auto now = substitute(guard, 30, 10, 10);
  EXPECT_LE(now - start, 1100ms);
  EXPECT_NE(guard.reason(now).find("30 ms"), std::string::npos);
  EXPECT_NE(guard.reason(now).find("10 ms"), std::string::npos);
}

TEST(SpeedGuard, TriesAgainAfterPausesThatGrow) {
  SpeedGuard guard;
  auto now = substitute(guard, 30, 10, 10);
  EXPECT_EQ(guard.reason(now + 5s), "");
  now = substitute(guard, 30, 10, 10, now + 5s);
  EXPECT_NE(guard.reason(now + 5s), "");
  EXPECT_EQ(guard.reason(now + 10s), "");
}

TEST(SpeedGuard, ForgivesOneSlowImage) {
  SpeedGuard guard;
  guard.substituted(200, 30, start);
  const auto now = substitute(guard, 10, 30, 5, start + 50ms);
  EXPECT_EQ(guard.reason(now), "");
}

}  // namespace
}  // namespace understudy::spu
