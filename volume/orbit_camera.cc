// SPDX-License-Identifier: Apache-2.0
#include "volume/orbit_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "volume/description.h"
#include "volume/matrix.h"
#include "volume/request.h"

namespace understudy::volume {

namespace {

constexpr double nearest = 1e-3;  // distance of the near plane, in half diagonals
constexpr double farthest_eye = 1e6;

Matrix4 perspective(int width, int height, double near, double far) {
  const double shorter = 1 / std::tan(orbit_field_of_view * std::numbers::pi / 360);
  const double side = std::min(width, height);
  Matrix4 m{};
  m[0] = shorter * side / width;
  m[5] = shorter * side / height;
  m[10] = (far + near) / (near - far);
  m[11] = 2 * far * near / (near - far);
  m[14] = -1;
  return m;
}

}  // namespace

Vec3 eye_direction(const OrbitCamera& camera) {
  const double azimuth = camera.azimuth * std::numbers::pi / 180,
               elevation = camera.elevation * std::numbers::pi / 180;
  return {std::cos(elevation) * std::sin(azimuth), -std::cos(elevation) * std::cos(azimuth),
          std::sin(elevation)};
}

RenderRequest orbit_request(const VolumeDescription& volume, const Vec3& spacing, const OrbitCamera& camera,
                            int width, int height, double step) {
  if (!(std::isfinite(camera.azimuth) && std::isfinite(camera.roll) && std::abs(camera.elevation) <= 90 &&
        camera.distance > 0 && camera.distance <= farthest_eye))
    throw std::invalid_argument(fmt::format(
        "a camera at azimuth {}, elevation {} and distance {} makes no sense; give degrees, -90 to 90 for "
        "the second, and a positive distance in half diagonals of the volume",
        camera.azimuth, camera.elevation, camera.distance));
  if (width < 1 || height < 1)
    throw std::invalid_argument(fmt::format("an image of {} x {} pixels has none", width, height));
  if (!(step > 0 && std::isfinite(step)))
    throw std::invalid_argument(fmt::format("a step of {} voxels leads nowhere; give a positive one", step));

  Vec3 extent{};
  for (std::size_t k = 0; k < 3; ++k) extent[k] = volume.size[k] * spacing[k];
  const double radius = length(extent) / 2;
  Matrix4 to_world = identity();
  for (std::size_t k = 0; k < 3; ++k) {
    to_world[5 * k] = extent[k] / radius;
    to_world[4 * k + 3] = -extent[k] / radius / 2;
  }

  // Derives the axes from the angles instead of an up vector: no singularity at the poles.
  const double azimuth = camera.azimuth * std::numbers::pi / 180, roll = camera.roll * std::numbers::pi / 180;
  const Vec3 level{std::cos(azimuth), std::sin(azimuth), 0};
  const Vec3 back = eye_direction(camera);
  const Vec3 side = add(scale(level, std::cos(roll)), scale(cross(back, level), std::sin(roll)));
  const Vec3 up = cross(back, side);
  const Matrix4 to_eye{side[0], side[1], side[2],          0, up[0], up[1], up[2], 0, back[0],
                       back[1], back[2], -camera.distance, 0, 0,     0,     1};

  RenderRequest request;
  request.volume = volume.id;
  request.version = volume.version;
  request.viewport = request.window = {0, 0, width, height};
  const double near = std::max(camera.distance - 1.01, nearest);
  request.texture_to_clip =
      multiply(perspective(width, height, near, camera.distance + 1.01), multiply(to_eye, to_world));
  RaySteps& steps = request.steps.emplace();
  const double unit = *std::ranges::min_element(spacing) * step;
  for (std::size_t k = 0; k < 3; ++k) steps.metric[4 * k] = extent[k] / unit;
  steps.first = 0.5;
  return request;
}

}  // namespace understudy::volume
