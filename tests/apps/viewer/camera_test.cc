// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/model/camera.h"

#include <gtest/gtest.h>

namespace viewer {
namespace {

std::array<double, 4> transform(const Mat4& m, const Vec3& p) {
  std::array<double, 4> result{};
  for (int row = 0; row < 4; ++row)
    result[row] = m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row];
  return result;
}

TEST(Camera, LooksAtTheOriginFromItsDistance) {
  for (const double azimuth : {0.0, 37.0, 180.0, 300.0})
    for (const double elevation : {-90.0, -20.0, 0.0, 55.0, 90.0}) {
      const Camera camera{azimuth, elevation, 2.5, false};
      const auto origin = transform(matrices_of(camera, 640, 480).modelview, {0, 0, 0});
      EXPECT_NEAR(origin[0], 0, 1e-12);
      EXPECT_NEAR(origin[1], 0, 1e-12);
      EXPECT_NEAR(origin[2], -2.5, 1e-12);
      const auto ahead = transform(matrices_of(camera, 640, 480).modelview, view_direction(camera));
      EXPECT_NEAR(ahead[2], -3.5, 1e-12) << "the direction of view leads away from the eye";
    }
}

TEST(Camera, AzimuthZeroLooksAlongYAndElevationNinetyDown) {
  EXPECT_NEAR(view_direction({0, 0, 2, false})[1], 1, 1e-12);
  EXPECT_NEAR(view_direction({0, 90, 2, false})[2], -1, 1e-12);
  // At azimuth 90 the eye is at +x.
  EXPECT_NEAR(view_direction({90, 0, 2, false})[0], -1, 1e-12);
}

TEST(Camera, DefaultDistanceShowsTheWholeBoundingSphereInAnyWindowShape) {
  for (const bool orthographic : {false, true})
    for (const auto& [width, height] : {std::pair{512, 512}, std::pair{300, 700}, std::pair{700, 300}}) {
      const Matrices m = matrices_of({20, 30, 2, orthographic}, width, height);
      const Mat4 clip_from_object = m.projection * m.modelview;
      for (int i = 0; i < 500; ++i) {
        // Fibonacci points on the sphere of radius 1/2.
        const double z = 1 - (2 * i + 1) / 500.0, angle = i * 2.399963;
        const double r = std::sqrt(1 - z * z);
        const auto clip =
            transform(clip_from_object, {0.5 * r * std::cos(angle), 0.5 * r * std::sin(angle), 0.5 * z});
        for (int axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(clip[axis]), clip[3]);
      }
    }
}

TEST(Camera, FieldOfViewSpansTheShorterSide) {
  for (const double degrees : {10.0, 40.0, 120.0})
    for (const auto& [width, height] : {std::pair{300, 700}, std::pair{700, 300}}) {
      const Matrices m = matrices_of({0, 0, 2, false, degrees}, width, height);
      const double half = 2 * std::tan(radians(degrees / 2));
      const auto clip =
          transform(m.projection * m.modelview, width < height ? Vec3{half, 0, 0} : Vec3{0, 0, half});
      EXPECT_NEAR(clip[width < height ? 0 : 1] / clip[3], 1, 1e-12);
    }
}

TEST(Camera, DraggingAndZoomingStayInRange) {
  Camera camera;
  rotate(camera, 1e5, 1e5);
  EXPECT_EQ(camera.elevation, 90);
  EXPECT_LE(std::abs(camera.azimuth), 180);
  zoom(camera, 1000);
  EXPECT_EQ(camera.distance, min_distance);
  zoom(camera, -1000);
  EXPECT_EQ(camera.distance, max_distance);
}

}  // namespace
}  // namespace viewer
