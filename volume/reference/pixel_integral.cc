#include "volume/reference/pixel_integral.h"

#include <algorithm>
#include <stdexcept>

#include "volume/matrix.h"

namespace understudy::volume {

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
  double enter = 0, leave = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    if (way[k] == 0) {
      if (near[k] < request.region.low[k] || near[k] > request.region.high[k]) return std::nullopt;
      continue;
    }
    const double a = (request.region.low[k] - near[k]) / way[k],
                 b = (request.region.high[k] - near[k]) / way[k];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (!(enter < leave)) return std::nullopt;
  PixelRay ray{add(near, scale(way, enter)), add(near, scale(way, leave)), 0};
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

}  // namespace understudy::volume
