// SPDX-License-Identifier: Apache-2.0
#include "volume/reference/pixel_integral.h"

#include <algorithm>
#include <stdexcept>

#include "volume/matrix.h"
#include "volume/reference/stored_field.h"
#include "volume/request.h"

namespace understudy::volume {

namespace {

/// A part of the path from a pixel's point on the near plane (0) to its point on the far plane (1).
struct Kept {
  double enter = 0;
  double leave = 1;

  /// Keeps the part where value + t * slope >= 0.
  void keep(double value, double slope) {
    if (slope > 0) enter = std::max(enter, -value / slope);
    if (slope < 0) leave = std::min(leave, -value / slope);
    if (slope == 0 && value < 0) leave = enter;
  }
};

std::optional<float> depth_before(const RenderRequest& request, int x, int y) {
  if (!request.depth) return std::nullopt;
  const Rect& rect = request.depth->rect;
  if (x < rect.x || y < rect.y || x >= rect.x + rect.width || y >= rect.y + rect.height) return std::nullopt;
  return request.depth->depth[std::size_t(y - rect.y) * std::size_t(rect.width) + std::size_t(x - rect.x)];
}

}  // namespace

std::optional<PixelRay> pixel_ray(const RenderRequest& request, int x, int y) {
  if (!request.steps) throw std::invalid_argument("the request's samples lie on planes, not on steps");
  const auto clip_to_texture = inverse(request.texture_to_clip);
  if (!clip_to_texture) throw std::invalid_argument("the matrix from texture to clip space is singular");
  const double across = 2 * (x + 0.5 - request.viewport.x) / request.viewport.width - 1;
  const double up = 2 * (y + 0.5 - request.viewport.y) / request.viewport.height - 1;
  const auto point_at = [&](double depth) {
    const Vec4 p = transform(*clip_to_texture, {across, up, depth, 1});
    return Vec3{p[0] / p[3], p[1] / p[3], p[2] / p[3]};
  };
  const Vec3 near = point_at(-1), way = subtract(point_at(1), near);
  Kept kept;
  for (std::size_t k = 0; k < 3; ++k) {
    kept.keep(near[k] - request.region.low[k], way[k]);
    kept.keep(request.region.high[k] - near[k], -way[k]);
  }
  for (const HalfSpace& plane : request.clip_planes)
    kept.keep(dot(plane.normal, near) + plane.offset, dot(plane.normal, way));
  if (const auto depth = depth_before(request, x, y)) {
    const auto& [first, last] = request.depth_range;
    if (first == last) return std::nullopt;
    const Vec3 seen = subtract(point_at(2 * (double(*depth) - first) / (last - first) - 1), near);
    kept.leave = std::min(kept.leave, dot(seen, way) / dot(way, way));
  }
  if (!(kept.enter < kept.leave)) return std::nullopt;
  PixelRay ray{add(near, scale(way, kept.enter)), add(near, scale(way, kept.leave)), 0};
  const Vec3 inside = subtract(ray.to, ray.from);
  const auto& metric = request.steps->metric;
  Vec3 in_steps{};
  for (std::size_t row = 0; row < 3; ++row)
    in_steps[row] = dot({metric[3 * row], metric[3 * row + 1], metric[3 * row + 2]}, inside);
  ray.length = length(in_steps);
  return ray;
}

std::array<double, 4> pixel_integral(const Field& field, const std::array<int, 3>& size,
                                     const RenderRequest& request, const Medium& medium, int x, int y) {
  const auto ray = pixel_ray(request, x, y);
  if (!ray) return {};
  const auto stretches = field_along_ray(field, size, ray->from, ray->to, ray->length);
  const RayIntegral sum = ray_integral(stretches, medium);
  return {sum.colour[0], sum.colour[1], sum.colour[2], sum.opacity()};
}

RayIntegral stored_pixel_integral(const BrickStore& store, const RenderRequest& request, const Medium& medium,
                                  int x, int y, double tolerance) {
  const auto ray = pixel_ray(request, x, y);
  if (!ray) return {};
  return ray_integral(stored_field_along_ray(store, ray->from, ray->to, ray->length), medium, tolerance);
}

}  // namespace understudy::volume
