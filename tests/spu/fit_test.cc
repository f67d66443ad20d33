// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/geometry/fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "volume/matrix.h"
#include "volume/texture_space.h"

namespace understudy::spu {
namespace {

using volume::Matrix4;
using volume::Vec3;

Matrix4 perspective(double near, double far) {
  const double f = 2.5;
  return {f, 0, 0,  0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), 2 * far * near / (near - far),
          0, 0, -1, 0};
}

Matrix4 looking(double x, double y, double z) {
  const double c = std::cos(0.4);
  const double s = std::sin(0.4);
  return {c, 0, s, x, s * 0.3, 0.95, -c * 0.3, y, -s, 0.3, c, z, 0, 0, 0, 1};
}

/// Slices as a viewer draws them: equidistant quads through the unit cube.
std::vector<ObservedVertex> quads_under(const Matrix4& a, int slices, double rounding = 0, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> noise(-rounding, rounding);
  std::vector<ObservedVertex> vertices;
  for (int i = 0; i < slices; ++i) {
    const double z = (i + 0.5) / slices;
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) {
      ObservedVertex v;
      v.texture = {x, y, z};
      v.clip = volume::transform_point(a, v.texture);
      for (double& c : v.clip) c *= 1 + noise(random);
      vertices.push_back(v);
    }
  }
  return vertices;
}

double largest_difference(const Matrix4& a, const Matrix4& b) {
  double largest = 0;
  for (std::size_t i = 0; i < 16; ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

TEST(CameraFit, FindsAPerspectiveCameraToDoublePrecision) {
  const Matrix4 a = volume::multiply(perspective(1, 20), looking(-0.5, -0.5, -5));
  const auto fit = fit_camera(quads_under(a, 100));
  ASSERT_TRUE(fit);
  std::printf("largest error of an entry %.2e, residual %.2e\n", largest_difference(fit->texture_to_clip, a),
              fit->residual);
  EXPECT_LT(largest_difference(fit->texture_to_clip, a), 1e-11);
  EXPECT_LT(fit->residual, 1e-12);
}

TEST(CameraFit, TwoSlicesAreEnough) {
  const Matrix4 a = volume::multiply(perspective(1, 20), looking(0, 0, -3));
  const auto fit = fit_camera(quads_under(a, 2));
  ASSERT_TRUE(fit);
  EXPECT_LT(largest_difference(fit->texture_to_clip, a), 1e-11);
}

TEST(CameraFit, FloatRoundingStaysFarBelowTheTolerance) {
  const Matrix4 a = volume::multiply(perspective(1, 20), looking(-0.5, -0.5, -5));
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto fit = fit_camera(quads_under(a, 250, 6e-8, seed));
    ASSERT_TRUE(fit) << "seed " << seed;
    EXPECT_LT(fit->residual, 1e-5) << "seed " << seed;
  }
}

TEST(CameraFit, AWorldOffsetOf1e7KeepsTheUnitVolume) {
  // Clip positions are the pipeline's float results, in which the offset has already cancelled.
  Matrix4 a = looking(-1e7, 1e7, -5);
  const auto fit = fit_camera(quads_under(a, 100));
  ASSERT_TRUE(fit);
  EXPECT_LT(largest_difference(fit->texture_to_clip, a) / 1e7, 1e-12);
}

TEST(CameraFit, MirroredAndShearedVolumesAreCamerasToo) {
  const Matrix4 a =
      volume::multiply(perspective(0.1, 100), {-1, 0.7, 0, 0.2, 0, 2, 0, 0.1, 0.3, 0, 0.01, -4, 0, 0, 0, 1});
  const auto fit = fit_camera(quads_under(a, 64));
  ASSERT_TRUE(fit);
  EXPECT_LT(largest_difference(fit->texture_to_clip, a), 1e-9);
}

TEST(CameraFit, OneSliceDoesNotDetermineACamera) {
  EXPECT_FALSE(fit_camera(quads_under(looking(0, 0, -3), 1)));
}

TEST(CameraFit, ThreePointsDoNotDetermineACamera) {
  const auto vertices = quads_under(looking(0, 0, -3), 4);
  EXPECT_FALSE(fit_camera(std::span(vertices).first(3)));
}

TEST(CameraFit, NotANumberIsNoCamera) {
  auto vertices = quads_under(looking(0, 0, -3), 10);
  vertices[17].texture[1] = std::nan("");
  EXPECT_FALSE(fit_camera(vertices));
  vertices = quads_under(looking(0, 0, -3), 10);
  vertices[3].clip[2] = INFINITY;
  EXPECT_FALSE(fit_camera(vertices));
}

TEST(CameraFit, ABentMapHasALargeResidual) {
  auto vertices = quads_under(looking(0, 0, -3), 50);
  for (ObservedVertex& v : vertices) v.clip[0] += 0.05 * v.texture[0] * v.texture[1] * v.texture[2];
  const auto fit = fit_camera(vertices);
  ASSERT_TRUE(fit);
  std::printf("residual %.2e\n", fit->residual);
  EXPECT_GT(fit->residual, max_fit_residual);
}

}  // namespace
}  // namespace understudy::spu
