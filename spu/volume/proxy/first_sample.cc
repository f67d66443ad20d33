// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/first_sample.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/ray_probes.h"
#include "spu/volume/proxy/step_fit.h"

namespace understudy::spu {
namespace {

using volume::Rgba;

/// Returns the length, in steps, below which `rule` gives a ray no sample.
double shortest_counted(const volume::RaySteps& rule, const std::optional<Jitter>& jitter) {
  if (rule.divided) return 1 - rule.rounding;
  return rule.first + (jitter ? std::max(jitter->steps_per_unit, 0.0) : 0.0);
}

Rgba ray_of_one_sample(const March& march, float value) {
  const Rgba sample = even_sample(march, value);
  return march.shows_one_colour() ? sample : ray_of(march, sample, 1);
}

/// Returns two values for which the colours of a ray of one sample differ most; null if they hardly differ.
/// Whatever a ray without a sample shows, it cannot match both.
std::optional<std::array<float, 2>> unlike_values(const March& march, const std::vector<float>& values) {
  constexpr float told_apart = 1e-4F;
  const auto farthest_from = [&](float value) {
    const Rgba from = ray_of_one_sample(march, value);
    return *std::ranges::max_element(
        values, {}, [&](float other) { return largest_difference(from, ray_of_one_sample(march, other)); });
  };
  const float one = farthest_from(values.front());
  const float other = farthest_from(one);
  if (!(largest_difference(ray_of_one_sample(march, one), ray_of_one_sample(march, other)) > told_apart))
    return std::nullopt;
  return std::array{one, other};
}

/// Returns rays of about `counted` / 2 steps in several directions, with the length at the pixel that is drawn.
std::vector<Ray> short_rays(const FieldProbe& probe, const RaysThroughBox& rays, const volume::RaySteps& rule,
                            double counted) {
  constexpr double shortest = 0.02;  // of a step: shorter rays may miss their pixel
  std::vector<Ray> found = rays_of_length(rays, rule, counted / 2);
  for (Ray& ray : found) {
    const auto drawn = probe.middle_of_pixel_at(ray.x, ray.y);
    const auto way = rays.way(drawn[0], drawn[1]);
    ray = {drawn[0], drawn[1], way ? steps_of_way(rule, *way) : 0};
  }
  std::erase_if(found, [&](const Ray& ray) { return !(ray.length > shortest && ray.length < 0.9 * counted); });
  return found;
}

}  // namespace

bool takes_first_sample_anyway(const MarchContext& measured, FieldProbe& probe, const RaysThroughBox& rays,
                               const March& march, const volume::RaySteps& rule,
                               const std::vector<float>& values) {
  constexpr std::ptrdiff_t fewest_rays = 3;
  const double counted = shortest_counted(rule, march.jitter);
  if (march.background || rule.counted_from || !(counted > 0)) return false;
  const auto unlike = unlike_values(march, values);
  if (!unlike) return false;
  const std::array expected{ray_of_one_sample(march, unlike->front()),
                            ray_of_one_sample(march, unlike->back())};
  const float near = largest_difference(expected[0], expected[1]) / 4;
  const float latest = march.jitter && march.jitter->steps_per_unit > 0 ? 1 : 0;
  if (march.jitter && !begin_rays_at(measured.run, probe, *march.jitter, latest)) return false;
  const bool already = premultiplied_already(measured, march);
  std::ptrdiff_t with_sample = 0;
  std::ptrdiff_t drawn = 0;
  for (const Ray& ray : short_rays(probe, rays, rule, counted)) {
    const auto fragments = probe.at(ray.x, ray.y, *unlike);
    if (!std::ranges::all_of(fragments, reached)) continue;
    ++drawn;
    const bool both = largest_difference(premultiplied(fragments[0], already), expected[0]) <= near &&
                      largest_difference(premultiplied(fragments[1], already), expected[1]) <= near;
    if (both) ++with_sample;
  }
  if (march.jitter) show_own_noise(measured.run, probe, *march.jitter);
  return drawn >= fewest_rays && with_sample == drawn;
}

}  // namespace understudy::spu
