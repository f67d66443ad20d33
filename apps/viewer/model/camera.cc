// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/model/camera.h"

#include <algorithm>

namespace viewer {

namespace {

// Larger than the distance of anything drawn from the origin: the box reaches 0.5,
// frame and axes a little more.
constexpr double scene_radius = 0.75;

Mat4 orientation(const Camera& camera) {
  return rotation_x(radians(camera.elevation - 90)) * rotation_z(radians(-camera.azimuth));
}

Mat4 perspective(double right, double top, double near, double far) {
  return {near / right,
          0,
          0,
          0,
          0,
          near / top,
          0,
          0,
          0,
          0,
          -(far + near) / (far - near),
          -1,
          0,
          0,
          -2 * far * near / (far - near),
          0};
}

Mat4 orthographic(double right, double top, double near, double far) {
  return {1 / right, 0, 0, 0, 0, 1 / top, 0, 0, 0, 0, -2 / (far - near), 0, 0, 0, -(far + near) / (far - near),
          1};
}

}  // namespace

Matrices matrices_of(const Camera& camera, int width, int height) {
  const double near = std::max(camera.distance - scene_radius, 0.01);
  const double far = camera.distance + scene_radius;
  const double depth = camera.orthographic ? camera.distance : near;
  const double half = depth * std::tan(radians(camera.field_of_view / 2));
  const double shorter = std::min(width, height);
  const double right = half * width / shorter, top = half * height / shorter;
  return {translation({0, 0, -camera.distance}) * orientation(camera),
          camera.orthographic ? orthographic(right, top, near, far) : perspective(right, top, near, far)};
}

Vec3 view_direction(const Camera& camera) {
  // The third row of the rotation, negated: the eye looks along -z.
  const Mat4 rotation = orientation(camera);
  return {-rotation[2], -rotation[6], -rotation[10]};
}

void rotate(Camera& camera, double right, double down) {
  constexpr double degrees_per_pixel = 0.5;
  camera.azimuth = std::remainder(camera.azimuth - right * degrees_per_pixel, 360.0);
  camera.elevation = std::clamp(camera.elevation + down * degrees_per_pixel, -90.0, 90.0);
}

void zoom(Camera& camera, double steps) {
  camera.distance = std::clamp(camera.distance * std::pow(0.9, steps), min_distance, max_distance);
}

}  // namespace viewer
