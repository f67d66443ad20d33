// SPDX-License-Identifier: Apache-2.0
// Camera control: the properties of an arcball, and that images follow the pointer.
#include "apps/understudy/view/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "volume/matrix.h"
#include "volume/request.h"

namespace understudy::launcher {
namespace {

using volume::Matrix4;
using volume::Vec3;

constexpr unsigned seed = 20061;

volume::RenderRequest request_of(const ViewCamera& camera, int width = 400, int height = 300) {
  volume::VolumeDescription description;
  description.size = {40, 50, 60};
  volume::RenderRequest request = volume::orbit_request(description, {1, 1, 2}, camera.orbit, width, height, 1);
  shift(request, camera.shift);
  return request;
}

double difference(const ViewCamera& a, const ViewCamera& b) {
  const Matrix4 x = request_of(a).texture_to_clip, y = request_of(b).texture_to_clip;
  double greatest = 0;
  for (std::size_t i = 0; i < 16; ++i) greatest = std::max(greatest, std::abs(x[i] - y[i]));
  return greatest;
}

/// Image position of a point in texture space, in halves of the shorter side.
ImagePoint seen(const ViewCamera& camera, const Vec3& t, int width, int height) {
  const Matrix4 m = request_of(camera, width, height).texture_to_clip;
  std::array<double, 4> clip{};
  for (std::size_t row = 0; row < 4; ++row)
    clip[row] = m[4 * row] * t[0] + m[4 * row + 1] * t[1] + m[4 * row + 2] * t[2] + m[4 * row + 3];
  const double shorter = std::min(width, height);
  return {clip[0] / clip[3] * width / shorter, clip[1] / clip[3] * height / shorter};
}

struct Hand {
  std::mt19937 random{seed};
  double number(double low, double high) { return std::uniform_real_distribution<>(low, high)(random); }
  ImagePoint point() { return {number(-1.3, 1.3), number(-1.3, 1.3)}; }
  ViewCamera camera() {
    return {{number(-400, 400), number(-90, 90), number(0.5, 8), number(-200, 200)},
            {number(-0.5, 0.5), number(-0.5, 0.5)}};
  }
};

TEST(Arcball, AnyWayEndsWhereOneMoveWouldAndBackAgainIsHome) {
  Hand hand;
  for (int i = 0; i < 1000; ++i) {
    const ViewCamera start = hand.camera();
    const ImagePoint a = hand.point(), b = hand.point(), c = hand.point();
    const ViewCamera by_way = rotated(rotated(start, a, b), b, c);
    EXPECT_LT(difference(by_way, rotated(start, a, c)), 1e-9);
    EXPECT_LT(difference(rotated(by_way, c, a), start), 1e-9);
    EXPECT_LE(std::abs(by_way.orbit.elevation), 90);
    EXPECT_EQ(by_way.orbit.distance, start.orbit.distance);
  }
}

TEST(Arcball, TurnsByTwiceTheAngleOnTheBall) {
  const ViewCamera start{{0, 0, 4, 0}, {}};
  const double angle = 0.2;
  const ViewCamera turned = rotated(start, {0, 0}, {std::sin(angle), 0});
  // What is in front moves to the right, so the camera moves to the left.
  EXPECT_NEAR(turned.orbit.azimuth, -2 * angle * 180 / std::numbers::pi, 1e-9);
  EXPECT_NEAR(turned.orbit.elevation, 0, 1e-9);
  EXPECT_NEAR(turned.orbit.roll, 0, 1e-9);
  const ViewCamera rolled = rotated(start, {1, 0}, {std::cos(angle), std::sin(angle)});
  EXPECT_NEAR(rolled.orbit.azimuth, 0, 1e-9);
  EXPECT_NEAR(std::abs(rolled.orbit.roll), 2 * angle * 180 / std::numbers::pi, 1e-9);
}

TEST(Arcball, WhatIsInFrontFollowsTheHand) {
  Hand hand;
  for (int i = 0; i < 200; ++i) {
    ViewCamera start = hand.camera();
    start.orbit.distance = 5;
    // The point of the volume nearest to the eye.
    const Vec3 towards = volume::eye_direction(start.orbit);
    const Vec3 extent{40, 50, 120};
    Vec3 front{};
    for (std::size_t k = 0; k < 3; ++k) front[k] = 0.5 + 20 * towards[k] / extent[k];
    const ImagePoint before = seen(start, front, 400, 300);
    const ImagePoint to{start.shift[0] + 0.05, start.shift[1] - 0.03};
    const ImagePoint after = seen(rotated(start, start.shift, to), front, 400, 300);
    EXPECT_GT(after[0], before[0]);
    EXPECT_LT(after[1], before[1]);
  }
}

TEST(Pan, MovesTheImageByWhatTheHandMovesWhateverItsShape) {
  Hand hand;
  for (const auto& [width, height] : {std::pair{400, 300}, std::pair{300, 400}})
    for (int i = 0; i < 200; ++i) {
      ViewCamera start = hand.camera();
      start.orbit.distance = std::max(2.0, start.orbit.distance);
      const Vec3 point{hand.number(0, 1), hand.number(0, 1), hand.number(0, 1)};
      const ImagePoint before = seen(start, point, width, height);
      const ImagePoint after = seen(panned(start, {0.25, -0.125}), point, width, height);
      EXPECT_NEAR(after[0] - before[0], 0.25, 1e-9);
      EXPECT_NEAR(after[1] - before[1], -0.125, 1e-9);
    }
}

TEST(Zoom, HoldsWhatIsUnderThePointerInThePlaneOfTheMiddleAndKeepsItsLimits) {
  const ViewCamera start{{30, 20, 4, 10}, {0.1, -0.2}};
  const ViewCamera nearer = zoomed(start, 2, start.shift);
  EXPECT_DOUBLE_EQ(nearer.orbit.distance, 2);
  EXPECT_EQ(nearer.shift, start.shift);
  const ViewCamera elsewhere = zoomed(start, 2, {0.5, 0.5});
  EXPECT_NEAR(elsewhere.shift[0], 0.5 + 2 * (0.1 - 0.5), 1e-12);
  EXPECT_NEAR(elsewhere.shift[1], 0.5 + 2 * (-0.2 - 0.5), 1e-12);
  EXPECT_EQ(zoomed(start, 1e9, {}).orbit.distance, nearest_distance);
  EXPECT_EQ(zoomed(start, 1e-9, {}).orbit.distance, farthest_distance);
}

}  // namespace
}  // namespace understudy::launcher
