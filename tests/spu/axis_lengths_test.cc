// SPDX-License-Identifier: Apache-2.0
// The metric of world space, derived from the camera alone.
#include "spu/volume/proxy/axis_lengths.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "volume/matrix.h"

namespace understudy::spu {
namespace {

using volume::Matrix4;
using volume::Vec3;

constexpr int width = 844, height = 527;

/// A rotation about a random axis through the origin.
Matrix4 random_rotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::array<double, 4> q{normal(random), normal(random), normal(random), normal(random)};
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (double& number : q) number /= norm;
  const auto [w, x, y, z] = q;
  return {1 - 2 * (y * y + z * z),
          2 * (x * y - z * w),
          2 * (x * z + y * w),
          0,
          2 * (x * y + z * w),
          1 - 2 * (x * x + z * z),
          2 * (y * z - x * w),
          0,
          2 * (x * z - y * w),
          2 * (y * z + x * w),
          1 - 2 * (x * x + y * y),
          0,
          0,
          0,
          0,
          1};
}

/// From texture space to eye space: a box with edges `edges`, rotated, at some distance in front of the eye.
Matrix4 model_view(const Vec3& edges, std::mt19937& random) {
  Matrix4 stretched = volume::identity();
  for (std::size_t k = 0; k < 3; ++k) {
    stretched[5 * k] = edges[k];
    stretched[4 * k + 3] = -edges[k] / 2;
  }
  Matrix4 moved = volume::identity();
  moved[3] = 0.3;
  moved[11] = -700;
  return volume::multiply(moved, volume::multiply(random_rotation(random), stretched));
}

Matrix4 perspective() {
  const double f = 2.1;
  const double aspect = double(width) / height;
  return {f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, -1.5, -40, 0, 0, -1, 0};
}

Matrix4 parallel() {
  const double aspect = double(width) / height;
  return {0.004 / aspect, 0, 0, 0, 0, 0.004, 0, 0, 0, 0, -0.0007, -0.2, 0, 0, 0, 1};
}

TEST(AxisLengths, AreThoseOfTheBox) {
  std::mt19937 random(5);
  for (const Matrix4& projection : {perspective(), parallel()}) {
    for (const Vec3& edges : {Vec3{100, 100, 226}, Vec3{256, 128, 64}, Vec3{1, 1, 1}, Vec3{30, 400, 90}}) {
      for (int view = 0; view < 20; ++view) {
        const auto found = axis_lengths(volume::multiply(projection, model_view(edges, random)), width, height);
        ASSERT_TRUE(found);
        const double longest = std::max({edges[0], edges[1], edges[2]});
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR((*found)[k], edges[k] / longest, 1e-6) << view;
      }
    }
  }
}

TEST(AxisLengths, AreNotToldByAViewAlongAnAxis) {
  Matrix4 straight = volume::identity();
  straight[11] = -5;
  EXPECT_FALSE(axis_lengths(volume::multiply(perspective(), straight), width, height));
  EXPECT_FALSE(axis_lengths(volume::multiply(parallel(), straight), width, height));
}

TEST(AxisLengths, AreNotToldOfAnObliqueBox) {
  std::mt19937 random(6);
  Matrix4 skewed = volume::identity();
  skewed[1] = 0.4;
  const auto view =
      volume::multiply(perspective(), volume::multiply(model_view({100, 80, 60}, random), skewed));
  EXPECT_FALSE(axis_lengths(view, width, height));
}

}  // namespace
}  // namespace understudy::spu
