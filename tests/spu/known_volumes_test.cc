// SPDX-License-Identifier: Apache-2.0
// Refusals of a volume: reported once, with evidence and advice on request, and dropped together with the
// volume.
#include "spu/volume/known_volumes/known_volumes.h"

#include <gtest/gtest.h>

#include "mock_driver.h"
#include "spu/track/share_group.h"

namespace understudy::spu::testing {
namespace {

/// What is written to stderr when the same refusal occurs twice.
std::string said_of(const Refusal& refusal, bool explain) {
  MockDriver driver;
  GlContext context;
  context.gl = &driver.table();
  Options options;
  options.explain = explain;
  const auto session = std::make_shared<RenderSession>(options);
  FrameAccount account(context, session->ledger(), &context);
  ShareGroup group;
  KnownVolumes volumes(group, session);
  ::testing::internal::CaptureStderr();
  volumes.refuse(7, refusal, account);
  volumes.refuse(7, refusal, account);
  EXPECT_EQ(volumes.find(7)->counters->draws_left.load(), 2U);
  volumes.forget_all();
  return ::testing::internal::GetCapturedStderr();
}

TEST(Refusal, IsSaidOnceWithItsReason) {
  EXPECT_EQ(said_of({"slices are bent", "by 3 degrees", "straighten them"}, false),
            "understudy: volume 7 not substituted: slices are bent\n");
}

TEST(Refusal, ExplainsWhatWasSeenAndWhatHelps) {
  EXPECT_EQ(said_of({"slices are bent", "by 3 degrees", "straighten them"}, true),
            "understudy: volume 7 not substituted: slices are bent\n"
            "understudy:   seen: by 3 degrees\n"
            "understudy:   what helps: straighten them\n");
  EXPECT_EQ(said_of("slices are bent", true), "understudy: volume 7 not substituted: slices are bent\n");
}

TEST(Refusal, StandsUntilALostComparisonMayBeTriedAgain) {
  MockDriver driver;
  const auto session = std::make_shared<RenderSession>(Options{});
  ShareGroup group;
  KnownVolumes volumes(group, session);
  KnownVolume& volume = volumes.of(7);
  EXPECT_FALSE(volumes.standing_refusal(7));
  Comparison lost;
  lost.difference.worst.excess = 1;
  EXPECT_THROW(take_comparison(lost, volume, 0), Refusal);
  volume.refusals.last_reason = "it was wrong";
  ASSERT_TRUE(volumes.standing_refusal(7));
  EXPECT_EQ(volumes.standing_refusal(7)->reason, "it was wrong");
  volume.refusals.next_try = 0;
  EXPECT_FALSE(volumes.standing_refusal(7));
  volume.refusals.handed_back = "it is not understood";
  EXPECT_EQ(volumes.standing_refusal(7)->reason, "it is not understood");
}

}  // namespace
}  // namespace understudy::spu::testing
