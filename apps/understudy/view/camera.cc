// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/view/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "volume/matrix.h"
#include "volume/request.h"

namespace understudy::launcher {
namespace {

using volume::add;
using volume::cross;
using volume::dot;
using volume::scale;
using volume::Vec3;

constexpr double degrees = 180 / std::numbers::pi;

/// The eye's axes in the volume's coordinates.
struct Axes {
  Vec3 side{}, up{}, back{};
};

/// The side axis of a camera without roll, as in orbit_request().
Vec3 level_side(double azimuth) {
  return {std::cos(azimuth), std::sin(azimuth), 0};
}

Axes axes_of(const volume::OrbitCamera& camera) {
  const double roll = camera.roll / degrees;
  Axes axes;
  axes.back = volume::eye_direction(camera);
  const Vec3 level = level_side(camera.azimuth / degrees);
  axes.side = add(scale(level, std::cos(roll)), scale(cross(axes.back, level), std::sin(roll)));
  axes.up = cross(axes.back, axes.side);
  return axes;
}

void set_axes(volume::OrbitCamera& camera, const Axes& axes) {
  const double across = std::hypot(axes.back[0], axes.back[1]);
  camera.elevation = std::atan2(axes.back[2], across) * degrees;
  // At the poles any azimuth is valid, because the roll compensates for it.
  const double azimuth = across > 0 ? std::atan2(axes.back[0], -axes.back[1]) : camera.azimuth / degrees;
  camera.azimuth = azimuth * degrees;
  const Vec3 level = level_side(azimuth);
  camera.roll = std::atan2(dot(axes.side, cross(axes.back, level)), dot(axes.side, level)) * degrees;
}

Vec3 on_ball(const ImagePoint& point) {
  const double squared = point[0] * point[0] + point[1] * point[1];
  if (squared <= 1) return {point[0], point[1], std::sqrt(1 - squared)};
  const double far = std::sqrt(squared);
  return {point[0] / far, point[1] / far, 0};
}

}  // namespace

ViewCamera rotated(const ViewCamera& camera, const ImagePoint& from, const ImagePoint& to) {
  const auto around_middle = [&](const ImagePoint& point) {
    return on_ball({point[0] - camera.shift[0], point[1] - camera.shift[1]});
  };
  const Vec3 a = around_middle(from), b = around_middle(to);
  // The quaternion (w, v), which rotates by twice the angle.
  const double w = dot(a, b);
  const Vec3 v = cross(a, b);
  const auto turned = [&](const Vec3& p) {
    const Vec3 t = scale(cross(v, p), 2);
    return add(add(p, scale(t, w)), cross(v, t));
  };
  // The volume rotates before the eye: rotate each of its axes, in eye coordinates.
  const Axes axes = axes_of(camera.orbit);
  std::array<Vec3, 3> seen{};
  for (std::size_t k = 0; k < 3; ++k) seen[k] = turned({axes.side[k], axes.up[k], axes.back[k]});
  Axes now;
  for (std::size_t k = 0; k < 3; ++k) {
    now.side[k] = seen[k][0];
    now.up[k] = seen[k][1];
    now.back[k] = seen[k][2];
  }
  ViewCamera result = camera;
  set_axes(result.orbit, now);
  return result;
}

ViewCamera panned(const ViewCamera& camera, const ImagePoint& by) {
  ViewCamera result = camera;
  for (std::size_t k = 0; k < 2; ++k)
    result.shift[k] = std::clamp(camera.shift[k] + by[k], -farthest_shift, farthest_shift);
  return result;
}

ViewCamera zoomed(const ViewCamera& camera, double factor, const ImagePoint& at) {
  ViewCamera result = camera;
  result.orbit.distance = std::clamp(camera.orbit.distance / factor, nearest_distance, farthest_distance);
  const double grown = camera.orbit.distance / result.orbit.distance;
  for (std::size_t k = 0; k < 2; ++k)
    result.shift[k] = std::clamp(at[k] + (camera.shift[k] - at[k]) * grown, -farthest_shift, farthest_shift);
  return result;
}

void shift(volume::RenderRequest& request, const ImagePoint& shift) {
  const double shorter = std::min(request.viewport.width, request.viewport.height);
  const std::array<double, 2> in_clip{shift[0] * shorter / request.viewport.width,
                                      shift[1] * shorter / request.viewport.height};
  for (std::size_t row = 0; row < 2; ++row)
    for (std::size_t column = 0; column < 4; ++column)
      request.texture_to_clip[4 * row + column] += in_clip[row] * request.texture_to_clip[12 + column];
}

}  // namespace understudy::launcher
