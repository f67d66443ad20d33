// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/extreme_jitter.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <utility>

#include "spu/volume/proxy/extreme_steps.h"
#include "spu/volume/proxy/step_fit.h"

namespace understudy::spu {
namespace {

constexpr double most_elsewhere = 0.05;        ///< of rays, as in lie_on()
constexpr double colours_of_8_bits = 0.3;      ///< of a step
constexpr double shortest_displacement = 0.6;  ///< of a step: colours do not resolve less

/// Keeps the rays that have samples wherever they begin: on shorter ones, some programs take one beyond the
/// end.
std::vector<RayEnds> long_ones(std::vector<RayEnds> ends, const volume::RaySteps& rule) {
  constexpr double long_enough = 2.5;  // steps
  std::erase_if(ends,
                [&](const RayEnds& ray) { return steps_of_way(rule, ray.way) < rule.first + long_enough; });
  return ends;
}

/// Returns the median number of steps by which first samples lie behind the position that `rule` gives them.
double later_than(const volume::RaySteps& rule, std::span<const RayEnds> ends) {
  std::vector<double> displacements;
  displacements.reserve(ends.size());
  for (const RayEnds& ray : ends) displacements.push_back(ray.first * steps_of_way(rule, ray.way) - rule.first);
  if (displacements.empty()) return 0;
  const auto middle = displacements.begin() + std::ptrdiff_t(displacements.size() / 2);
  std::ranges::nth_element(displacements, middle);
  return *middle;
}

volume::RaySteps moved_by(volume::RaySteps rule, volume::RayOffsets numbers, const Jitter& jitter) {
  for (float& number : numbers.steps) number = float(number * jitter.steps_per_unit);
  rule.offsets = std::move(numbers);
  return rule;
}

/// False if rays that begin later have fewer samples; true if they have as many, which then lie beyond the end.
/// Null if neither fits.
std::optional<bool> only_moves(const volume::RaySteps& rule, double displacement,
                               std::span<const RayEnds> later) {
  volume::RaySteps moved = rule;
  moved.first += displacement;
  if (lie_on(moved, later)) return false;
  moved.counted_from = rule.first;
  if (lie_on(moved, later)) return true;
  return std::nullopt;
}

std::optional<ExtremeJitter> jitter_by(const MarchContext& measured, FieldProbe& probe,
                                       const SampledTexture& texture, const volume::TransferFunction& table,
                                       const ProxyBox& box) {
  const auto numbers = noise_in(measured.context, texture);
  if (!numbers) return std::nullopt;
  volume::RayOffsets shown = *numbers;
  const auto ends_under = [&](const auto& texel) {
    std::ranges::generate(shown.steps, texel);
    probe.show_instead(texture, shown.width, shown.height, shown.steps);
    return ends_of_rays(measured, probe, table, box);
  };
  const std::vector<RayEnds> sooner = ends_under([] { return 0.0F; });
  ExtremeJitter found{{texture.sampler_location, 0}, steps_of(sooner, measured, probe, box)};
  if (found.steps.empty()) return std::nullopt;
  const volume::RaySteps rule = found.steps.front();

  const std::vector<RayEnds> later = long_ones(ends_under([] { return 1.0F; }), rule);
  double& displacement = found.jitter.steps_per_unit;
  displacement = later_than(rule, later);
  if (std::abs(displacement - std::round(displacement)) < 0.02) displacement = std::round(displacement);
  if (!(displacement > shortest_displacement)) return std::nullopt;
  const auto moves_only = only_moves(rule, displacement, later);
  if (!moves_only) return std::nullopt;
  found.jitter.moves_only = *moves_only;

  std::mt19937 random(1);
  const std::vector<RayEnds> mixed = long_ones(ends_under([&] { return float(random() & 1U); }), rule);
  if (mixed.empty() || !begin_as_said(moved_by(rule, shown, found.jitter), mixed)) return std::nullopt;
  probe.show_own(texture);
  const std::vector<RayEnds> own = ends_of_rays(measured, probe, table, box);
  if (!begin_as_said(moved_by(rule, *numbers, found.jitter), own)) return std::nullopt;
  return found;
}

}  // namespace

bool begin_as_said(const volume::RaySteps& steps, std::vector<RayEnds> ends) {
  const std::vector<RayEnds> told = long_ones(std::move(ends), steps);
  const auto elsewhere = std::ranges::count_if(told, [&](const RayEnds& ray) {
    const double expected = steps.first + (steps.offsets ? steps.offsets->at(ray.x, ray.y) : 0.0);
    return !(std::abs(ray.first * steps_of_way(steps, ray.way) - expected) <= colours_of_8_bits);
  });
  return double(elsewhere) <= most_elsewhere * double(told.size());
}

std::optional<ExtremeJitter> find_extreme_jitter(const MarchContext& measured, FieldProbe& probe,
                                                 const volume::TransferFunction& table, const ProxyBox& box) {
  for (const SampledTexture& texture : measured.run.pipeline().others) {
    auto found = jitter_by(measured, probe, texture, table, box);
    probe.show_own(texture);
    if (found) return found;
  }
  return std::nullopt;
}

}  // namespace understudy::spu
