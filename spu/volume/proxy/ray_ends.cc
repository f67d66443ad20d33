// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/ray_ends.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "spu/volume/proxy/step_fit.h"
#include "volume/footprint.h"
#include "volume/matrix.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::spu {
namespace {

using volume::Vec3;
using volume::Vec4;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A stretch of a ray, as fractions of its path from the near plane to the far plane.
struct Stretch {
  double enter = -infinity;
  double leave = infinity;

  /// Keeps the part in which value + t * slope >= 0.
  void keep(double value, double slope) {
    if (slope > 0) enter = std::max(enter, -value / slope);
    if (slope < 0) leave = std::min(leave, -value / slope);
    if (slope == 0 && value < 0) leave = -infinity;
  }
};

Vec3 point(const Vec4& homogeneous) {
  return {homogeneous[0] / homogeneous[3], homogeneous[1] / homogeneous[3], homogeneous[2] / homogeneous[3]};
}

/// The ray of one pixel: its stretch in the box, and what planes leave of it.
struct PixelRay {
  PixelRay(const volume::RenderRequest& request, const volume::Matrix4& clip_to_texture,
           const std::vector<volume::HalfSpace>& planes, int x, int y)
      : depth_range(request.depth_range) {
    const double ndc_x = 2 * (x + 0.5 - request.viewport.x) / request.viewport.width - 1;
    const double ndc_y = 2 * (y + 0.5 - request.viewport.y) / request.viewport.height - 1;
    const Vec4 near = volume::transform(clip_to_texture, {ndc_x, ndc_y, -1, 1});
    const Vec4 far = volume::transform(clip_to_texture, {ndc_x, ndc_y, 1, 1});
    w_near = near[3];
    w_far = far[3];
    const Vec3 start = point(near);
    along = volume::subtract(point(far), start);
    for (std::size_t k = 0; k < 3; ++k) {
      in_box.keep(start[k] - request.region.low[k], along[k]);
      in_box.keep(request.region.high[k] - start[k], -along[k]);
    }
    kept = in_box;
    for (const volume::HalfSpace& plane : planes)
      kept.keep(volume::dot(plane.normal, start) + plane.offset, volume::dot(plane.normal, along));
  }

  /// Returns the window depth at t. Depth is linear in homogeneous coordinates, not in t.
  double depth_at(double t) const {
    const double s = t > 0 ? t * w_near / (t * w_near + (1 - t) * w_far) : 0;
    return depth_range[0] + s * (depth_range[1] - depth_range[0]);
  }

  /// Whether the ray enters in front of opaque geometry at `depth`.
  bool enters_before(float depth) const {
    return kept.enter < kept.leave && depth_at(kept.enter) <= double(depth);
  }

  std::array<double, 2> depth_range;
  double w_near = 1;
  double w_far = 1;
  Vec3 along{};
  Stretch in_box;
  Stretch kept;
};

/// Returns the window depths of the application's opaque geometry; beyond any depth where there is none.
volume::DepthImage depths_over(const volume::Rect& rect, const volume::RenderRequest& request) {
  constexpr float beyond_every_depth = 2;
  volume::DepthImage image;
  image.rect = rect;
  image.depth.assign(rect.pixels(), beyond_every_depth);
  if (!request.depth) return image;
  const volume::DepthImage& known = *request.depth;
  image.or_equal = known.or_equal;
  const volume::Rect both = volume::intersection(rect, known.rect);
  for (int y = both.y; y < both.y + both.height; ++y) {
    const auto from =
        known.depth.begin() + (std::ptrdiff_t(y - known.rect.y) * known.rect.width + (both.x - known.rect.x));
    std::copy_n(from, both.width,
                image.depth.begin() + (std::ptrdiff_t(y - rect.y) * rect.width + (both.x - rect.x)));
  }
  return image;
}

/// Determines which pixels' rays enter the box, between the planes, in front of opaque geometry.
class EnteringRays {
 public:
  EnteringRays(const std::vector<volume::HalfSpace>& planes, const volume::RenderRequest& request,
               const volume::Rect& rect)
      : planes_(planes),
        request_(request),
        depth_(depths_over(rect, request)),
        clip_to_texture_(volume::inverse(request.texture_to_clip)) {}

  /// For a pixel of the rectangle, in window coordinates.
  bool at(int x, int y) const {
    if (!clip_to_texture_) return false;
    const volume::Rect& rect = depth_.rect;
    const auto pixel = std::size_t(y - rect.y) * std::size_t(rect.width) + std::size_t(x - rect.x);
    return PixelRay(request_, *clip_to_texture_, planes_, x, y).enters_before(depth_.depth[pixel]);
  }

 private:
  const std::vector<volume::HalfSpace>& planes_;
  const volume::RenderRequest& request_;
  const volume::DepthImage depth_;
  const std::optional<volume::Matrix4> clip_to_texture_;
};

}  // namespace

void end_rays_at(const std::vector<volume::HalfSpace>& planes, double past_planes,
                 volume::RenderRequest& request) {
  constexpr auto no_sample = float(volume::max_planes);  // begins beyond the end of every ray
  const auto back = volume::inverse(request.texture_to_clip);
  const volume::Rect rect = volume::footprint(request, request.region);
  if (planes.empty() || !back || rect.empty() || !request.steps) return;
  volume::RaySteps& steps = *request.steps;
  volume::DepthImage depth = depths_over(rect, request);
  volume::RayOffsets offsets{rect.width, rect.height, std::vector<float>(rect.pixels(), no_sample)};
  std::size_t pixel = 0;
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    for (int x = rect.x; x < rect.x + rect.width; ++x, ++pixel) {
      const PixelRay ray(request, *back, planes, x, y);
      if (!ray.enters_before(depth.depth[pixel])) continue;
      const double steps_along = steps_of_way(steps, ray.along);
      const double noise = steps.offsets ? steps.offsets->at(x, y) : 0;
      const auto tile_x = std::size_t((x % rect.width + rect.width) % rect.width);
      const auto tile_y = std::size_t((y % rect.height + rect.height) % rect.height);
      offsets.steps[tile_y * std::size_t(rect.width) + tile_x] =
          float((ray.kept.enter - ray.in_box.enter) * steps_along + noise);
      if (ray.kept.leave >= ray.in_box.leave) continue;
      // A program that checks for the end after each sample takes the first one in any case.
      const double way = (ray.kept.leave - ray.kept.enter) * steps_along;
      const double shown = past_planes > 0 ? std::max(way, steps.first) + past_planes : way;
      const double end = ray.kept.enter + (shown - steps.past_depth) / steps_along;
      depth.depth[pixel] = std::min(depth.depth[pixel], float(ray.depth_at(end)));
    }
  }
  steps.offsets = std::move(offsets);
  request.depth = std::move(depth);
}

void cover_entered(const std::vector<volume::HalfSpace>& planes, const volume::RenderRequest& request,
                   float alpha, volume::Image& image) {
  const EnteringRays entering(planes, request, image.rect);
  auto pixel = image.rgba.begin();
  for (int y = image.rect.y; y < image.rect.y + image.rect.height; ++y) {
    for (int x = image.rect.x; x < image.rect.x + image.rect.width; ++x, pixel += 4) {
      if (pixel[3] == 0 && entering.at(x, y)) pixel[3] = alpha;
    }
  }
}

void fill_behind_entered(const std::vector<volume::HalfSpace>& planes, const volume::RenderRequest& request,
                         const ShaderBackground& background, volume::Image& image) {
  const EnteringRays entering(planes, request, image.rect);
  auto pixel = image.rgba.begin();
  for (int y = image.rect.y; y < image.rect.y + image.rect.height; ++y) {
    for (int x = image.rect.x; x < image.rect.x + image.rect.width; ++x, pixel += 4) {
      if (pixel[3] > 0 || entering.at(x, y))
        std::ranges::copy(over_background(background, {pixel[0], pixel[1], pixel[2], pixel[3]}), pixel);
    }
  }
}

}  // namespace understudy::spu
