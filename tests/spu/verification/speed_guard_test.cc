// SPDX-License-Identifier: Apache-2.0
// The application draws itself when that is faster.
#include "spu/volume/timing/speed_guard.h"

#include <gtest/gtest.h>

namespace understudy::spu {
namespace {

using namespace std::chrono_literals;

constexpr SpeedGuard::Clock::time_point start{1h};

constexpr auto frame = 100ms;

/// A viewer that shows a frame every 100 ms for some time.
struct Viewer {
  SpeedGuard guard;
  SpeedGuard::Clock::time_point now = start;
  std::uint64_t state = 1;
  int attempts = 0;

  /// Counts the attempts within `time`; `attempt` tells the guard the outcome of each.
  template <class Attempt>
  int attempts_in(std::chrono::seconds time, Attempt attempt) {
    attempts = 0;
    for (const auto end = now + time; now < end; now += frame) {
      guard.about_to_draw(state, now);
      if (guard.pauses(now)) continue;
      ++attempts;
      attempt();
    }
    return attempts;
  }
  int shown(std::chrono::seconds time, double ours_ms, double native_ms) {
    return attempts_in(time, [&] { guard.shown(ours_ms, native_ms, now); });
  }
  int refused(std::chrono::seconds time, double ms) {
    return attempts_in(time, [&] { guard.refused(ms, now); });
  }
};

TEST(SpeedGuard, SubstitutesWhatIsFaster) {
  Viewer viewer;
  EXPECT_EQ(viewer.shown(10s, 10, 30), 100);
}

TEST(SpeedGuard, LeavesWhatIsSlowerAfterThreeImages) {
  Viewer viewer;
  EXPECT_EQ(viewer.shown(1s, 30, 10), 3);
  EXPECT_NE(viewer.guard.slower().find("30 ms"), std::string::npos);
  EXPECT_NE(viewer.guard.slower().find("10 ms"), std::string::npos);
}

TEST(SpeedGuard, AttemptsThatGainNothingBecomeRarer) {
  Viewer viewer;
  EXPECT_EQ(viewer.shown(1s, 150, 100), 3);
  // 50 ms are 2 % of 2.5 s; they are charged 4, 8 and 16 times, and 16 times from then on.
  EXPECT_LE(viewer.shown(100s, 150, 100), 6);
  EXPECT_NEAR(viewer.shown(1000s, 150, 100), 25, 1);
}

TEST(SpeedGuard, AnAttemptThatGainsIsFollowedByOthers) {
  Viewer viewer;
  viewer.shown(100s, 150, 100);
  viewer.attempts_in(40s, [&] { viewer.guard.shown(50, 100, viewer.now); });
  EXPECT_EQ(viewer.shown(1s, 50, 100), 10);
  // From then on, slower attempts are charged as the first ones were.
  viewer.shown(1s, 150, 100);
  EXPECT_GE(viewer.shown(20s, 150, 100), 2);
}

TEST(SpeedGuard, RefusalsTakeAFiftiethOfTheTime) {
  Viewer viewer;
  EXPECT_EQ(viewer.refused(1s, 50), 3);
  EXPECT_LE(50.0 * viewer.refused(100s, 50), 0.02 * 101'000 + 50.0);
  EXPECT_TRUE(viewer.guard.slower().empty());
}

/// As when a comparison fails after the camera moved: there is no reason to expect more from the next image.
TEST(SpeedGuard, ARefusalAfterAnImageEndsTheFirstLook) {
  Viewer viewer;
  viewer.guard.about_to_draw(viewer.state, viewer.now);
  viewer.guard.shown(150, 100, viewer.now);
  viewer.now += frame;
  EXPECT_EQ(viewer.refused(1s, 50), 1);
  // A different program or different contents get new attempts.
  viewer.now += 5s;
  viewer.state = 2;
  EXPECT_EQ(viewer.refused(1s, 50), 3);
}

TEST(SpeedGuard, ALongRefusalEndsTheFirstLook) {
  Viewer viewer;
  EXPECT_EQ(viewer.refused(10s, 2000), 1);
}

TEST(SpeedGuard, TheFirstImagePaysForWhatIsMeasuredOnce) {
  Viewer viewer;
  viewer.refused(0s, 0);
  viewer.guard.refused(200, viewer.now);
  viewer.guard.shown(900, 100, viewer.now);
  EXPECT_EQ(viewer.shown(10s, 90, 100), 100);
}

TEST(SpeedGuard, ForgivesOneSlowImage) {
  Viewer viewer;
  viewer.shown(1s, 50, 100);
  viewer.guard.shown(450, 100, viewer.now);
  EXPECT_EQ(viewer.shown(1s, 50, 100), 10);
}

TEST(SpeedGuard, WhatWasGainedLongAgoDoesNotExcuseBeingSlower) {
  Viewer viewer;
  viewer.shown(60s, 10, 100);
  EXPECT_LE(viewer.shown(5s, 150, 100), 10);
}

TEST(SpeedGuard, LooksAgainWhereTheProgramIsAnother) {
  Viewer viewer;
  viewer.refused(10s, 400);
  viewer.state = 2;
  EXPECT_EQ(viewer.refused(1s, 50), 3);
  viewer.state = 3;
  EXPECT_EQ(viewer.refused(1s, 50), 0);  // too soon
}

TEST(SpeedGuard, MakesAnAttemptThatIsLikelyToSucceed) {
  Viewer viewer;
  viewer.refused(1s, 400);
  viewer.guard.allow_another();
  EXPECT_EQ(viewer.refused(1s, 400), 1);
}

TEST(SpeedGuard, ManyVolumesShareTheTimeForAttempts) {
  constexpr int volumes = 10;
  SpeedGuard alone, one_of_many;
  one_of_many.share_among(volumes);
  const SpeedGuard::Clock::time_point start{std::chrono::hours(1)};
  for (SpeedGuard* const guard : {&alone, &one_of_many})
    for (int i = 0; i < SpeedGuard::first_attempts; ++i) guard->refused(1, start);
  // 3 ms are 2 % of 150 ms.
  const auto later = [&](int ms) { return start + std::chrono::milliseconds(ms); };
  EXPECT_TRUE(alone.pauses(later(140)));
  EXPECT_FALSE(alone.pauses(later(160)));
  EXPECT_TRUE(one_of_many.pauses(later(140 * volumes)));
  EXPECT_FALSE(one_of_many.pauses(later(160 * volumes)));
}

}  // namespace
}  // namespace understudy::spu
