// SPDX-License-Identifier: Apache-2.0
// When a substituted image is compared with the application's own.
#include "spu/volume/verification/schedule.h"

#include <gtest/gtest.h>

#include <limits>

namespace understudy::spu {
namespace {

using Effect = VerificationSchedule::Effect;
using Inputs = VerificationSchedule::Inputs;

constexpr std::size_t footprint = 1000;
constexpr double native_ms = 100;

/// Begins an image, and reports a due comparison as successful. Returns whether one was due.
bool compared(VerificationSchedule& schedule, const Inputs& inputs, std::size_t pixels = footprint) {
  schedule.begin(inputs, pixels);
  const bool whole = schedule.whole_due();
  if (whole) schedule.whole_was_right(true, native_ms);
  return whole;
}

TEST(VerificationSchedule, ComparesTheFirstImageAndNotTheSecond) {
  VerificationSchedule schedule;
  EXPECT_TRUE(compared(schedule, {{1}}));
  EXPECT_FALSE(compared(schedule, {{1}}));
}

TEST(VerificationSchedule, BoundsByHalfWhatDecidesAboutSamples) {
  VerificationSchedule schedule;
  const auto bound_at = [&](float plane, float eye) {
    schedule.begin({{plane, Effect::decides}, {eye, Effect::unknown}}, footprint);
    const double bound = schedule.bound();
    schedule.whole_was_right(true, native_ms);
    return bound;
  };
  EXPECT_EQ(bound_at(1, 1), 1) << "the first";
  EXPECT_EQ(bound_at(1, 2), 1);
  for (int image = 0; image < 10; ++image) EXPECT_EQ(bound_at(2 + float(image), 2), 0.5) << image;
  EXPECT_EQ(bound_at(11, 2), 1) << "nothing has changed";
}

TEST(VerificationSchedule, AnImageOfNothingProvesNothing) {
  VerificationSchedule schedule;
  for (int image = 0; image < 20; ++image) {
    schedule.begin({{1}}, footprint);
    ASSERT_TRUE(schedule.whole_due());
    schedule.whole_was_right(false, native_ms);
  }
  EXPECT_TRUE(compared(schedule, {{1}}));
  EXPECT_FALSE(compared(schedule, {{1}}));
}

TEST(VerificationSchedule, ComparesAgainWhenTheVolumeCoversMoreOfTheWindow) {
  VerificationSchedule schedule;
  compared(schedule, {{1}}, 1000);
  EXPECT_FALSE(compared(schedule, {{1}}, 1400));
  EXPECT_TRUE(compared(schedule, {{1}}, 1600));
  EXPECT_FALSE(compared(schedule, {{1}}, 1600));
  EXPECT_FALSE(compared(schedule, {{1}}, 100));
}

TEST(VerificationSchedule, TrustsWhatIsMeasuredAfterItWasRightAFewTimes) {
  VerificationSchedule schedule;
  compared(schedule, {{0, Effect::measured}});
  int whole = 0;
  for (int image = 1; image <= 20; ++image) whole += compared(schedule, {{float(image), Effect::measured}});
  EXPECT_EQ(whole, trusted_changes);
}

TEST(VerificationSchedule, DrawsMoreSentinelsWhereATableOfSamplesChanges) {
  VerificationSchedule schedule;
  compared(schedule, {{0, Effect::predicted}});
  int quiet = 0;
  for (int image = 0; image < 50; ++image) {
    compared(schedule, {{0, Effect::predicted}});
    quiet += schedule.sentinels();
    schedule.sentinels_took(schedule.sentinels(), schedule.sentinels());
  }
  int edited = 0;
  for (int image = 1; image <= 50; ++image) {
    EXPECT_FALSE(compared(schedule, {{float(image), Effect::predicted}}));
    edited += schedule.sentinels();
    schedule.sentinels_took(schedule.sentinels(), schedule.sentinels());
  }
  EXPECT_GT(edited, 5 * quiet);
}

TEST(VerificationSchedule, NeverTrustsWhatMayDecideAboutFragments) {
  VerificationSchedule schedule;
  compared(schedule, {{0, Effect::unknown}});
  for (int image = 1; image <= 20; ++image) EXPECT_TRUE(compared(schedule, {{float(image), Effect::unknown}}));
}

TEST(VerificationSchedule, FollowsTheCameraBySentinels) {
  VerificationSchedule schedule;
  compared(schedule, {{0, Effect::followed}});
  int sentinels = 0;
  for (int image = 1; image <= 20; ++image) {
    ASSERT_FALSE(compared(schedule, {{float(image), Effect::followed}}));
    sentinels += schedule.sentinels();
    schedule.sentinels_took(schedule.sentinels(), schedule.sentinels() * 1.0);
  }
  EXPECT_GE(sentinels, int(20 * 100 * sentinel_share) - 1);
}

TEST(VerificationSchedule, SendsMoreSentinelsWhileWhatIsMeasuredChanges) {
  VerificationSchedule schedule;
  for (int image = 0; image < 10; ++image) compared(schedule, {{float(image)}});
  int sentinels = 0;
  for (int image = 10; image < 30; ++image) {
    ASSERT_FALSE(compared(schedule, {{float(image)}}));
    sentinels += schedule.sentinels();
    schedule.sentinels_took(schedule.sentinels(), schedule.sentinels() * 2.0);
  }
  EXPECT_GE(sentinels, int(0.9 * 20 * native_ms * dense_sentinel_share / 2.0));
}

TEST(VerificationSchedule, ASecondInputIsNotTrustedForTheFirst) {
  VerificationSchedule schedule;
  compared(schedule, {{0}, {0}});
  for (int image = 1; image <= 10; ++image) compared(schedule, {{float(image)}, {0}});
  EXPECT_FALSE(compared(schedule, {{11}, {0}}));
  EXPECT_TRUE(compared(schedule, {{11}, {1}}));
}

TEST(VerificationSchedule, WhatIsNoNumberHasAlwaysChanged) {
  VerificationSchedule schedule;
  const Inputs inputs{{std::numeric_limits<float>::quiet_NaN(), Effect::unknown}};
  for (int image = 0; image < 5; ++image) EXPECT_TRUE(compared(schedule, inputs));
}

TEST(VerificationSchedule, AnotherNumberOfInputsIsAnotherImage) {
  VerificationSchedule schedule;
  compared(schedule, {{0}});
  EXPECT_TRUE(compared(schedule, {{0}, {0}}));
  EXPECT_FALSE(compared(schedule, {{0}, {0}}));
}

TEST(VerificationSchedule, AChangeIsNotForgottenWhereItWasNotCompared) {
  VerificationSchedule schedule;
  compared(schedule, {{0}});
  schedule.begin({{1}}, footprint);
  ASSERT_TRUE(schedule.whole_due());
  // Nothing was compared, because the nodes were lost.
  schedule.begin({{1}}, footprint);
  EXPECT_TRUE(schedule.whole_due());
}

TEST(VerificationSchedule, SentinelsTakeOnePercentOfTheApplicationsTime) {
  VerificationSchedule schedule;
  compared(schedule, {{0}});
  double spent = 0;
  constexpr double ms_a_sentinel = 0.7;
  for (int image = 0; image < 1000; ++image) {
    schedule.begin({{0}}, footprint);
    const int count = schedule.sentinels();
    schedule.sentinels_took(count, count * ms_a_sentinel);
    spent += count * ms_a_sentinel;
  }
  EXPECT_LE(spent, 1.0001 * 1000 * native_ms * sentinel_share);
  EXPECT_GE(spent, 0.9 * 1000 * native_ms * sentinel_share);
}

TEST(VerificationSchedule, TheApplicationsTimeGoesByItsSamples) {
  VerificationSchedule schedule;
  schedule.begin({{0}}, 1000, 2);
  schedule.whole_was_right(true, native_ms);
  schedule.begin({{0}}, 500, 2);
  EXPECT_DOUBLE_EQ(schedule.native_ms().value_or(0), native_ms / 2);
  schedule.begin({{0}}, 500, 0.5);
  EXPECT_DOUBLE_EQ(schedule.native_ms().value_or(0), native_ms / 8);
}

TEST(VerificationSchedule, ComparesSeveralImagesWhereTheyAreAskedFor) {
  VerificationSchedule schedule;
  schedule.ask_for_several();
  int whole = 0;
  for (int image = 0; image < 20; ++image) whole += compared(schedule, {{0}});
  EXPECT_EQ(whole, right_after_loss);
}

TEST(VerificationSchedule, GivesUpAfterLossesInARowAndNotBefore) {
  VerificationSchedule schedule;
  for (int loss = 1; loss < max_lost_comparisons; ++loss) schedule.lost();
  EXPECT_FALSE(schedule.gives_up());
  schedule.lost();
  EXPECT_TRUE(schedule.gives_up());
}

TEST(VerificationSchedule, ARightImageForgivesLossesButNotForEver) {
  VerificationSchedule schedule;
  for (int loss = 1; loss < max_lost_comparisons_ever; ++loss) {
    schedule.lost();
    ASSERT_FALSE(schedule.gives_up()) << loss;
    for (int image = 0; image < right_after_loss; ++image) ASSERT_TRUE(compared(schedule, {{float(loss)}}));
    ASSERT_FALSE(compared(schedule, {{float(loss)}}));
  }
  schedule.lost();
  EXPECT_TRUE(schedule.gives_up());
}

}  // namespace
}  // namespace understudy::spu
