// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/first_sample.h"

#include <algorithm>
#include <array>
#include <vector>

#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/ray_probes.h"

namespace understudy::spu {
namespace {

using volume::Rgba;

/// Rays shorter than this many steps have no sample, as they are counted.
double shortest_counted(const volume::RaySteps& rule, const std::optional<Jitter>& jitter) {
  if (rule.divided) return 1 - rule.rounding;
  return rule.first + (jitter ? std::max(jitter->steps_per_unit, 0.0) : 0.0);
}

float most_seen(const Rgba& colour) {
  return *std::ranges::max_element(colour);
}

}  // namespace

bool takes_first_sample_anyway(const MarchContext& measured, FieldProbe& probe, const RaysThroughBox& rays,
                               const March& march, const volume::RaySteps& rule,
                               const std::vector<float>& values) {
  constexpr double shortest = 0.02;  // of a step: shorter rays may miss their pixel
  constexpr std::ptrdiff_t fewest_rays = 3;
  const double counted = shortest_counted(rule, march.jitter);
  if (march.background || rule.counted_from || counted <= shortest) return false;
  const float value = *std::ranges::max_element(
      values, {}, [&](float candidate) { return most_seen(even_sample(march, candidate)); });
  const float of_sample = most_seen(even_sample(march, value));
  if (!(of_sample > 0)) return false;
  if (march.jitter && !begin_rays_at(measured.run, probe, *march.jitter, 1)) return false;
  const bool already = premultiplied_already(measured, march);
  std::ptrdiff_t seen = 0;
  std::ptrdiff_t told = 0;
  for (const Ray& ray : rays_of_length(rays, rule, counted / 2)) {
    if (!(ray.length > shortest && ray.length < 0.9 * counted)) continue;
    const Rgba fragment = probe.at(ray.x, ray.y, std::array{value}).front();
    if (!reached(fragment)) continue;
    ++told;
    if (most_seen(premultiplied(fragment, already)) > of_sample / 4) ++seen;
  }
  if (march.jitter) show_own_noise(measured.run, probe, *march.jitter);
  return told >= fewest_rays && seen == told;
}

}  // namespace understudy::spu
