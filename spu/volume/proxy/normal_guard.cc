// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/normal_guard.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/ray_normals.h"

namespace understudy::spu {

using volume::NormalGuard;
using volume::Rgba;

namespace {

/// In units of the least measurable rise.
constexpr std::array<double, 9> steepnesses{0.25, 1, 4, 16, 64, 256, 1024, 4096, 16384};

/// A slope of one steepness and angle: what the ray's values show, and what this depends on.
struct SeenSteepness {
  std::vector<Tint> tints;
  std::vector<double> opacities;  ///< of the ray's samples
  EvenRise rise;
};

/// Returns slopes of all steepnesses that face the eye, and that lean away from it; empty if one shows nothing,
/// or another opacity than constant fields.
std::vector<SeenSteepness> seen_steepnesses(SlopeProbe& slopes, const LitRay& plain,
                                            const LightSpace& directions, const volume::Light& light) {
  constexpr float same_opacity = 0.01F;
  std::vector<SeenSteepness> seen;
  for (const double angle : {0.0, 0.6, 1.1}) {
    const volume::Vec3 gradient = directions.gradient(angle, 0.7 + angle);
    for (const double steepness : steepnesses) {
      const std::vector<Rgba> shown = slopes.over(plain, plain.values, gradient, steepness);
      for (std::size_t v = 0; v < shown.size(); ++v) {
        if (!reached(shown[v]) || !(std::abs(shown[v][3] - plain.base[v][3]) <= same_opacity)) return {};
      }
      seen.push_back({tints_of(shown), slopes.opacities_over(plain, plain.values.front(), gradient, steepness),
                      slopes.rise(gradient, steepness, light.reach)});
    }
  }
  return seen;
}

/// Returns the largest error of a light over all that was seen, relative to the brightest channel where this
/// exceeds 1.
double worst_difference(const LitRay& plain, const volume::RaySteps& steps, const LightSpace& directions,
                        const volume::Light& light, const std::vector<SeenSteepness>& all) {
  const std::vector<Tint> base = tints_of(plain.base);
  double worst = 0;
  for (const SeenSteepness& seen : all) {
    const auto normals = ray_normals(plain.way, steps, seen.opacities, directions, seen.rise, light.guard);
    for (std::size_t v = 0; v < base.size(); ++v) {
      const double here =
          difference(seen.tints[v], lit_tint(light, normals, base[v])) / std::max(1.0, brightest(seen.tints));
      if (!(here <= worst)) worst = std::isfinite(here) ? here : std::numeric_limits<double>::infinity();
    }
  }
  return worst;
}

/// How well a guard explains what is seen.
struct GuardFit {
  NormalGuard guard;
  double worst = 0;
};

/// Returns the best guard of this form: first among powers of two for its slope, then refined.
GuardFit best_of_form(NormalGuard::Form form, double gentlest,
                      const std::function<double(const NormalGuard&)>& worst) {
  // From a guard that hardly shows on the gentlest slope to one that shortens the steepest by a few hundredths.
  constexpr int powers = 18;
  constexpr int refinements = 11;  // to a few ten thousandths
  const double least = gentlest / 64;
  GuardFit best{{least, form}, worst({least, form})};
  const auto try_slope = [&](double slope) {
    const NormalGuard guard{slope, form};
    if (const double here = worst(guard); here < best.worst) best = {guard, here};
  };
  for (int i = 1; i < powers; ++i) try_slope(least * std::exp2(i));
  for (int i = 1; i <= refinements; ++i) {
    const double factor = std::exp2(std::exp2(-i));
    const double middle = best.guard.slope;
    for (const double slope : {middle / factor, middle * factor}) try_slope(slope);
  }
  return best;
}

}  // namespace

std::optional<volume::Light> with_normal_guard(SlopeProbe& slopes, const LitRay& plain,
                                               const volume::RaySteps& steps, const volume::Light& light) {
  constexpr double none = 0.008;
  constexpr double same = 0.015;
  const LightSpace directions(light, plain.way.way);
  const std::vector<SeenSteepness> seen = seen_steepnesses(slopes, plain, directions, light);
  if (seen.empty()) return std::nullopt;
  const auto worst = [&](const NormalGuard& guard) {
    volume::Light guarded = light;
    guarded.guard = guard;
    return worst_difference(plain, steps, directions, guarded, seen);
  };
  GuardFit best{{}, worst({})};
  if (best.worst > none) {
    const double gentlest = directions.slope(seen.front().rise.gradient);
    for (const NormalGuard::Form form :
         {NormalGuard::Form::added, NormalGuard::Form::root_of_squares, NormalGuard::Form::larger}) {
      const GuardFit of_form = best_of_form(form, gentlest, worst);
      if (of_form.worst < best.worst) best = of_form;
    }
  }
  if (!(best.worst <= same)) return std::nullopt;
  volume::Light guarded = light;
  guarded.guard = best.guard;
  return guarded;
}

}  // namespace understudy::spu
