// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/camera_followers.h"

#include <gtest/gtest.h>

#include <vector>

namespace understudy::spu::testing {
namespace {

using Camera = CameraFollowers::Camera;

/// An eye of three scalars that moves in every image, and a light of two.
struct Moving {
  CameraFollowers followers;
  MarchInputs before{};
  float eye = 0;
  bool light_chooses = false;

  /// Returns whether the light counts as a camera follower in the next image.
  bool light_follows(float light, Camera camera = Camera::moved_on) {
    const bool turned = camera != Camera::stayed;
    MarchInputs now;
    now.varying = {eye, 1, 2, light, 5};
    now.varying_begins = {0, 3};
    now.varying_chooses = {false, light_chooses};
    const std::vector<bool> follow = followers.look(before, now, camera);
    EXPECT_EQ(follow.size(), now.varying.size());
    EXPECT_EQ(follow[0], turned) << "the eye itself";
    EXPECT_EQ(follow[1], follow[0]) << "a vector is a whole";
    EXPECT_EQ(follow[3], follow[4]) << "a vector is a whole";
    before = now;
    eye += 1;
    return follow[3];
  }
};

TEST(CameraFollowers, AreWhatChangesWheneverTheCameraMoves) {
  Moving scene;
  for (int image = 0; image < 20; ++image) EXPECT_TRUE(scene.light_follows(float(image))) << image;
}

TEST(CameraFollowers, AreNoneWhereTheCameraStays) {
  Moving scene;
  scene.light_follows(1);
  EXPECT_FALSE(scene.light_follows(2, Camera::stayed));
}

TEST(CameraFollowers, MayRestForAShortWhile) {
  Moving scene;
  for (int image = 0; image < 10; ++image) scene.light_follows(float(image));
  for (int image = 0; image < 3; ++image) EXPECT_TRUE(scene.light_follows(9));
  EXPECT_TRUE(scene.light_follows(10));
}

TEST(CameraFollowers, AreNotWhatStayedWhileTheCameraMoved) {
  Moving scene;
  for (int image = 0; image < 10; ++image) EXPECT_TRUE(scene.light_follows(1)) << "nothing has changed";
  EXPECT_FALSE(scene.light_follows(2));
  EXPECT_TRUE(scene.light_follows(2)) << "nothing has changed";
  EXPECT_FALSE(scene.light_follows(3));
  EXPECT_FALSE(scene.light_follows(4));
  EXPECT_TRUE(scene.light_follows(5)) << "it has moved with the camera for a while";
}

TEST(CameraFollowers, AreNeverWhatStayedAndChoosesBetweenColours) {
  Moving scene{.light_chooses = true};
  for (int image = 0; image < 10; ++image) EXPECT_TRUE(scene.light_follows(1)) << "nothing has changed";
  for (int image = 0; image < 50; ++image) EXPECT_FALSE(scene.light_follows(float(2 + image))) << image;
}

TEST(CameraFollowers, AreNotWhatComesBackToWhatItWasUntilThatWasRightAFewTimes) {
  Moving scene;
  scene.light_follows(1);
  scene.light_follows(2);
  const auto follows_in_turns = [&] {
    int followed = 0;
    for (int turn = 0; turn < 4; ++turn) {
      followed += scene.light_follows(1) ? 1 : 0;
      followed += scene.light_follows(2) ? 1 : 0;
    }
    return followed;
  };
  EXPECT_LT(follows_in_turns(), 4);
  EXPECT_EQ(follows_in_turns(), 8);
  scene.followers.was_wrong();
  EXPECT_LT(follows_in_turns(), 4);
}

TEST(CameraFollowers, MayTakeTurnsWithTheCamera) {
  Moving scene;
  for (int turn = 0; turn < 8; ++turn) {
    EXPECT_TRUE(scene.light_follows(1, Camera::came_back)) << turn;
    EXPECT_TRUE(scene.light_follows(2, Camera::came_back)) << turn;
  }
}

TEST(CameraFollowers, AreNotWhatWasNotThereBefore) {
  Moving scene;
  for (int image = 0; image < 10; ++image) scene.light_follows(1);
  scene.before.varying_begins = {0};
  EXPECT_FALSE(scene.light_follows(2));
}

TEST(CameraFollowers, AreKnownByTheirNamesWhereOthersCome) {
  CameraFollowers followers;
  const auto image = [](float eye, float plane, bool also_plane) {
    MarchInputs inputs;
    if (also_plane) {
      inputs.begin_vector("plane", true);
      inputs.varying.push_back(plane);
    }
    inputs.begin_vector("eye", true);
    inputs.varying.push_back(eye);
    return inputs;
  };
  MarchInputs before;
  for (int k = 0; k < 10; ++k) {
    const MarchInputs now = image(float(k), 0, false);
    EXPECT_TRUE(followers.look(before, now, Camera::moved_on)[0]) << k;
    before = now;
  }
  // A flag makes a plane decide about samples: it must be right whenever it changes; the eye is trusted as
  // before.
  for (int k = 10; k < 30; ++k) {
    const MarchInputs now = image(float(k), float(k), true);
    const std::vector<bool> follow = followers.look(before, now, Camera::moved_on);
    EXPECT_FALSE(follow[0]) << k;
    EXPECT_TRUE(follow[1]) << k;
    before = now;
  }
}

}  // namespace
}  // namespace understudy::spu::testing
