// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/matrix.h"

#include <cmath>
#include <numbers>

namespace adversary {
namespace {

constexpr float near_plane = 0.1F, far_plane = 10;
constexpr Vector centre_of_cube{0.5F, 0.5F, 0.5F};

float radians(float degrees) {
  return degrees * std::numbers::pi_v<float> / 180;
}

Matrix perspective(float half_height, float aspect) {
  const float depth = near_plane - far_plane;
  return {1 / (half_height * aspect),
          0,
          0,
          0,
          0,
          1 / half_height,
          0,
          0,
          0,
          0,
          (near_plane + far_plane) / depth,
          -1,
          0,
          0,
          2 * near_plane * far_plane / depth,
          0};
}

Matrix parallel(float half_height, float aspect) {
  const float depth = near_plane - far_plane;
  return {1 / (half_height * aspect),       0, 0, 0, 0, 1 / half_height, 0, 0, 0, 0, 2 / depth, 0, 0, 0,
          (near_plane + far_plane) / depth, 1};
}

Matrix looking(Vector eye, Vector forward) {
  const Vector right = normalized(cross(forward, {0, 1, 0})), up = cross(right, forward);
  return {right.x, up.x, -forward.x, 0, right.y,          up.y,          -forward.y,        0,
          right.z, up.z, -forward.z, 0, -dot(right, eye), -dot(up, eye), dot(forward, eye), 1};
}

}  // namespace

const Matrix identity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

Vector cross(Vector a, Vector b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

Vector normalized(Vector a) {
  return (1 / std::sqrt(dot(a, a))) * a;
}

Matrix operator*(const Matrix& a, const Matrix& b) {
  Matrix product{};
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      for (int i = 0; i < 4; ++i) product[4 * column + row] += a[4 * i + row] * b[4 * column + i];
  return product;
}

Camera camera_at(const Orbit& orbit, int frame, float aspect) {
  const float azimuth = radians(orbit.azimuth + orbit.degrees_each_frame * static_cast<float>(frame));
  const float elevation = radians(orbit.elevation);
  const Vector away{std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                    std::cos(elevation) * std::cos(azimuth)};
  const Vector forward = -1.0F * away, right = normalized(cross(forward, {0, 1, 0}));
  const Vector eye = centre_of_cube + orbit.distance * away + orbit.sideways * right;
  const Matrix projection =
      orbit.projection == Projection::perspective ? perspective(0.268F, aspect) : parallel(0.7F, aspect);
  return {eye, forward, projection, looking(eye, forward)};
}

}  // namespace adversary
