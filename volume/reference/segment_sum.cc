// SPDX-License-Identifier: Apache-2.0
#include "volume/reference/segment_sum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <variant>

#include "volume/matrix.h"
#include "volume/reference/illumination.h"
#include "volume/reference/ray_integral.h"
#include "volume/request.h"

namespace understudy::volume {
namespace {

using Colour = std::array<double, 4>;  // premultiplied

/// The visible part of a ray. The parameter s goes from 0 at the near plane to 1 at the far plane; u counts
/// steps from the first sample.
struct Way {
  Vec3 near{}, far{};
  double first_s = 0;  ///< of the first sample
  double step_s = 0;
  double begin = 0, end = 0;  ///< in u
  int samples = 0;            ///< upper bound of their number

  Vec3 at(double u) const { return add(near, scale(subtract(far, near), first_s + u * step_s)); }
};

/// Narrows [low, high] to where a + b s >= 0.
void keep(double a, double b, double& low, double& high) {
  if (b > 0) low = std::max(low, -a / b);
  if (b < 0) high = std::min(high, -a / b);
  if (b == 0 && a < 0) high = -std::numeric_limits<double>::infinity();
}

std::optional<Way> way_of(const RenderRequest& request, const Matrix4& clip_to_texture, int x, int y) {
  const double across = 2 * (x + 0.5 - request.viewport.x) / request.viewport.width - 1;
  const double up = 2 * (y + 0.5 - request.viewport.y) / request.viewport.height - 1;
  const Vec4 n = transform(clip_to_texture, {across, up, -1, 1}),
             f = transform(clip_to_texture, {across, up, 1, 1});
  Way way;
  way.near = {n[0] / n[3], n[1] / n[3], n[2] / n[3]};
  way.far = {f[0] / f[3], f[1] / f[3], f[2] / f[3]};
  const Vec3 along = subtract(way.far, way.near);
  double enter = -std::numeric_limits<double>::infinity(), leave = -enter;
  for (std::size_t k = 0; k < 3; ++k) {
    keep(way.near[k] - request.region.low[k], along[k], enter, leave);
    keep(request.region.high[k] - way.near[k], -along[k], enter, leave);
  }
  if (!(enter < leave)) return std::nullopt;

  const RaySteps& rule = *request.steps;
  Vec3 metric_way{};
  for (std::size_t r = 0; r < 3; ++r)
    metric_way[r] = dot({rule.metric[3 * r], rule.metric[3 * r + 1], rule.metric[3 * r + 2]}, along);
  const double steps = length(metric_way) * (leave - enter);
  way.step_s = (leave - enter) / steps;
  way.samples = std::numeric_limits<int>::max();
  if (rule.divided) {
    way.samples = int(std::floor(steps + rule.rounding));
    if (way.samples < 1) return std::nullopt;
    way.step_s = (leave - enter) / way.samples;
  }
  way.first_s = enter + (rule.first + (rule.offsets ? rule.offsets->at(x, y) : 0)) * way.step_s;

  double low = std::max(enter, 0.0), high = std::min(leave, 1.0);
  for (const HalfSpace& plane : request.clip_planes)
    keep(dot(plane.normal, way.near) + plane.offset, dot(plane.normal, along), low, high);
  if (const auto& image = request.depth) {
    const int u = x - image->rect.x, v = y - image->rect.y;
    if (u >= 0 && v >= 0 && u < image->rect.width && v < image->rect.height) {
      const double depth = image->depth[std::size_t(v) * std::size_t(image->rect.width) + std::size_t(u)];
      const double z = (depth - request.depth_range[0]) / (request.depth_range[1] - request.depth_range[0]);
      // Depth z lies at the point (1 - z) n + z f in homogeneous coordinates.
      high = std::min(high, z * f[3] / ((1 - z) * n[3] + z * f[3]));
    }
  }
  way.begin = std::max((low - way.first_s) / way.step_s, -1.0);
  way.end = (high - way.first_s) / way.step_s;
  if (!(way.begin < way.end)) return std::nullopt;
  return way;
}

class Ray {
 public:
  Ray(const Field& field, const VolumeDescription& volume, const RenderRequest& request, const Way& way)
      : field_(field),
        volume_(volume),
        request_(request),
        function_(std::get<TransferFunction>(request.classification)),
        way_(way),
        surfaces_(request.surfaces) {
    std::stable_sort(surfaces_.begin(), surfaces_.end(),
                     [](const Surface& a, const Surface& b) { return a.value < b.value; });
    if (request.method == Method::pre_integrated) medium_ = Medium::of_samples(function_, 1);
  }

  Colour composed() {
    for (double u = way_.begin; u < way_.end;) {
      const double next = std::min(std::floor(u) + 1, way_.end);
      segment(u, next);
      u = next;
    }
    if (way_.end == std::floor(way_.end)) compose(sample(way_.end));
    return pixel_;
  }

 private:
  double value(double u) const { return field_(way_.at(u))[0]; }

  void compose(const Colour& colour) {
    const double room = 1 - pixel_[3];
    for (std::size_t k = 0; k < 4; ++k) pixel_[k] += room * colour[k];
  }

  Colour lit(double u, const Colour& colour) const {
    return illuminated(field_, volume_, *request_.light, way_.at(u), subtract(way_.far, way_.near), colour);
  }
  bool lights_samples() const { return request_.light && request_.light->on_samples; }

  /// The colour of the sample at u, lit; zero if there is none.
  Colour sample(double u) const {
    if (medium_ || u < 0 || u >= way_.samples) return {};
    const double v = value(u);
    if (std::isnan(v)) return {};
    const double last = double(function_.entries.size() - 1);
    const double place =
        std::clamp((v - function_.low) / (double(function_.high) - double(function_.low)) * last, 0.0, last);
    const auto below = std::min(std::size_t(place), function_.entries.size() - 2);
    Colour colour;
    for (std::size_t k = 0; k < 4; ++k)
      colour[k] = double(function_.entries[below][k]) +
                  (place - double(below)) *
                      (double(function_.entries[below + 1][k]) - double(function_.entries[below][k]));
    return lights_samples() ? lit(u, colour) : colour;
  }

  /// Composites a layer of `steps` steps, in a medium of which one step shows `colour`.
  void layer(const Colour& colour, double steps) {
    const double kept = -std::expm1(steps * std::log1p(-colour[3]));
    const double ratio = colour[3] > 0 ? kept / colour[3] : steps;
    compose({ratio * colour[0], ratio * colour[1], ratio * colour[2], kept});
  }

  void piece(double begin, double end, double at_begin, double at_end) {
    if (!medium_ || !(end > begin)) return;
    Stretch stretch;
    stretch.length = end - begin;
    stretch.value[0].c = {at_begin, at_end - at_begin, 0, 0};
    const RayIntegral sum = ray_integral(std::span(&stretch, 1), *medium_);
    const Colour colour{sum.colour[0], sum.colour[1], sum.colour[2], sum.opacity()};
    compose(lights_samples() ? lit((begin + end) / 2, colour) : colour);
  }

  void segment(double begin, double end) {
    const Colour sampled = begin == std::floor(begin) ? sample(begin) : Colour{};
    const double front = value(begin), back = value(end);
    if (std::isnan(front) || std::isnan(back)) return compose(sampled);
    double so_far = begin, at_so_far = front;
    for (std::size_t i = 0; i < surfaces_.size(); ++i) {
      const Surface& surface = surfaces_[front < back ? i : surfaces_.size() - 1 - i];
      // The field may equal the value over an interval: interpolation errors must not count as below it.
      constexpr double rounding = 1e-12;
      const auto above = [&](double v) { return v >= surface.value - rounding * std::abs(surface.value); };
      if (above(front) == above(back)) continue;
      double a = so_far, b = end;
      bool known = true;
      for (int i = 0; i < 60 && known; ++i) {
        const double middle = (a + b) / 2, there = value(middle);
        known = !std::isnan(there);
        (above(there) == above(front) ? a : b) = middle;
      }
      if (!known) continue;
      const double hit = (a + b) / 2;
      layer(sampled, hit - so_far);
      piece(so_far, hit, at_so_far, surface.value);
      Colour colour{surface.colour[0], surface.colour[1], surface.colour[2], surface.colour[3]};
      for (std::size_t k = 0; k < 3; ++k) colour[k] *= colour[3];
      compose(request_.light ? lit(hit, colour) : colour);
      so_far = hit;
      at_so_far = surface.value;
    }
    if (so_far > begin) {
      layer(sampled, begin + 1 - so_far);
    } else {
      compose(sampled);
    }
    piece(so_far, end, at_so_far, back);
  }

  const Field& field_;
  const VolumeDescription& volume_;
  const RenderRequest& request_;
  const TransferFunction& function_;
  const Way& way_;
  std::vector<Surface> surfaces_;
  std::optional<Medium> medium_;
  Colour pixel_{};
};

}  // namespace

ReferenceImage segment_sum(const Field& field, const VolumeDescription& volume, const RenderRequest& request,
                           const Rect& rect) {
  const auto clip_to_texture = inverse(request.texture_to_clip);
  if (!clip_to_texture) throw std::invalid_argument("the matrix from texture to clip space is singular");
  if (!request.steps) throw std::invalid_argument("segments lie between samples on steps, not on planes");
  ReferenceImage image{rect, std::vector<double>(4 * rect.pixels())};
  const Rect pixels = intersection(rect, intersection(request.window, request.viewport));
  for (int y = pixels.y; y < pixels.y + pixels.height; ++y)
    for (int x = pixels.x; x < pixels.x + pixels.width; ++x) {
      const auto way = way_of(request, *clip_to_texture, x, y);
      if (!way) continue;
      const Colour colour = Ray(field, volume, request, *way).composed();
      std::copy(colour.begin(), colour.end(), image.rgba.begin() + (image.at(x, y) - image.rgba.data()));
    }
  return image;
}

}  // namespace understudy::volume
