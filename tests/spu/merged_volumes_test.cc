// SPDX-License-Identifier: Apache-2.0
// The speed guard of a volume in many textures: one verdict for all bricks of a frame, because the whole is
// shown only if none is missing.
#include "spu/volume/merging/merged_volumes.h"

#include <gtest/gtest.h>

#include "mock_driver.h"
#include "spu/track/share_group.h"

namespace understudy::spu::testing {
namespace {

constexpr GLuint program = 1;

class SpeedOfMergedVolumes : public ::testing::Test {
 protected:
  /// The images of the volume take a hundred times as long as the application's own drawing.
  void be_slow() {
    for (int i = 0; i < SpeedGuard::first_attempts + 1; ++i)
      whole.volume.speed.shown(1000, 10, SpeedGuard::Clock::now());
  }
  void end_frame() { session->ledger().close(nullptr); }
  bool refused() { return merged.speed_refusal(whole, program).has_value(); }

  MockDriver driver;
  std::shared_ptr<RenderSession> session = std::make_shared<RenderSession>(Options{});
  ShareGroup group;
  KnownVolumes volumes{group, session};
  MergedVolumes merged{group, *session, volumes};
  MergedVolume whole;
};

TEST_F(SpeedOfMergedVolumes, ThatAreNotSlowerAreShown) {
  EXPECT_FALSE(refused());
  whole.volume.speed.shown(1, 10, SpeedGuard::Clock::now());
  end_frame();
  EXPECT_FALSE(refused());
}

TEST_F(SpeedOfMergedVolumes, ThatAreSlowerAreLeftToTheApplicationFromTheNextFrameOn) {
  EXPECT_FALSE(refused());
  be_slow();
  EXPECT_FALSE(refused()) << "the frame's first bricks wait already";
  end_frame();
  EXPECT_TRUE(refused());
  EXPECT_EQ(merged.speed_refusal(whole, program)->evidence,
            "substituting it took 1e+03 ms, the viewer's own drawing 10 ms");
}

TEST_F(SpeedOfMergedVolumes, StayLeftForTheWholeFrame) {
  EXPECT_FALSE(refused());
  be_slow();
  end_frame();
  EXPECT_TRUE(refused());
  whole.volume.speed.allow_another();
  EXPECT_TRUE(refused()) << "the frame's first bricks were drawn by the application";
  end_frame();
  EXPECT_FALSE(refused());
}

TEST(StateOfBricks, ChangesWithEachTextureAndTheProgram) {
  ShareGroup group;
  const std::array<GLuint, 2> textures{3, 4};
  const std::uint64_t before = state_of(textures, program, group);
  EXPECT_EQ(state_of(textures, program, group), before);
  EXPECT_NE(state_of(textures, program + 1, group), before);
  for (const GLuint texture : textures) {
    const std::uint64_t unchanged = state_of(textures, program, group);
    group.texture_changed(texture);
    EXPECT_NE(state_of(textures, program, group), unchanged) << texture;
  }
}

}  // namespace
}  // namespace understudy::spu::testing
