// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/gradient_reach.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "spu/volume/proxy/light_space.h"

namespace understudy::spu {

namespace {

// Widths of stripes, in FieldProbe::split_unit.
constexpr int wide = 64;
constexpr int narrow = 16;

/// How much brighter or darker a sample is that has another stripe within its reach.
struct StripeContrast {
  std::size_t channel = 0;  ///< the one that shows it best
  double plain = 0;         ///< of a sample without
  double lit = 0;           ///< what is added to `plain`
};

std::optional<StripeContrast> stripe_contrast(const SlopeProbe& slopes, const LitRay& ray,
                                              const volume::Light& light, std::size_t axis) {
  constexpr double tells = 0.05;
  const LightSpace space(light, ray.way.way);
  volume::Vec3 between_stripes{};
  between_stripes[axis] = slopes.stripes_differ(ray) / slopes.part_of_volume(axis, light.reach[axis]) / 2;
  const double cosine = space.cosine_across(axis) * light.guard.length_of_normal(space.slope(between_stripes));
  const Tint base = tint_of(ray.base.front());
  const Tint plain = lit_tint(light, std::nullopt, base);
  Tint lit{};
  for (const double side : {cosine, -cosine}) {
    const Tint one = lit_tint(light, side, base);
    for (std::size_t c = 0; c < 3; ++c) lit[c] += one[c] / 2;
  }
  std::size_t channel = 0;
  for (std::size_t c = 1; c < 3; ++c) {
    if (std::abs(lit[c] - plain[c]) > std::abs(lit[channel] - plain[channel])) channel = c;
  }
  const StripeContrast contrast{channel, plain[channel], lit[channel] - plain[channel]};
  if (std::abs(contrast.lit) < tells) return std::nullopt;
  return contrast;
}

/// Narrow stripes measure a short reach better, but none beyond a quarter of their width. `reach` in texture
/// space.
bool needs_narrow_stripes(double reach) {
  return reach < narrow * FieldProbe::split_unit / 4;
}

/// Returns the reach in texture space: over stripes of nearly one value, samples with another stripe within
/// their reach are lit.
double reach_over_stripes(SlopeProbe& slopes, const LitRay& ray, std::size_t axis, int width,
                          const StripeContrast& contrast) {
  const double part = (slopes.over_stripes(ray, axis, width)[contrast.channel] - contrast.plain) / contrast.lit;
  return part * width * FieldProbe::split_unit / 2;
}

/// Returns the reach in texels of the volume, rounded to half texels where the error of counting permits.
double in_texels(const SlopeProbe& slopes, std::size_t axis, double reach) {
  const double texels = slopes.reach_in_stripes(axis, reach);
  const double halves = std::round(2 * texels) / 2;
  return halves >= 1 && std::abs(texels - halves) < 0.1 ? halves : texels;
}

std::optional<double> gradient_reach_along(SlopeProbe& slopes, const LitRay& ray, const volume::Light& light,
                                           std::size_t axis) {
  const auto contrast = stripe_contrast(slopes, ray, light, axis);
  if (!contrast) return std::nullopt;
  double reach = reach_over_stripes(slopes, ray, axis, wide, *contrast);
  if (needs_narrow_stripes(reach)) reach = reach_over_stripes(slopes, ray, axis, narrow, *contrast);
  return in_texels(slopes, axis, reach);
}

}  // namespace

bool still_reaches(SlopeProbe& slopes, const LitRay& ray, const volume::Light& light, std::size_t axis) {
  constexpr double same = 0.1;  // of a texel
  const auto contrast = stripe_contrast(slopes, ray, light, axis);
  if (!contrast) return true;
  const double known = slopes.part_of_stripes(axis, light.reach[axis]);
  const int width = needs_narrow_stripes(known) ? narrow : wide;
  const double reach = in_texels(slopes, axis, reach_over_stripes(slopes, ray, axis, width, *contrast));
  return std::abs(reach - light.reach[axis]) <= same;
}

std::optional<std::array<double, 3>> gradient_reach(SlopeProbe& slopes, const LitRay& ray,
                                                    const volume::Light& light) {
  constexpr double least = 0.2;
  constexpr double most = 8;
  std::array<std::optional<double>, 3> seen;
  std::vector<double> known;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    seen[axis] = gradient_reach_along(slopes, ray, light, axis);
    if (seen[axis]) known.push_back(*seen[axis]);
  }
  std::array<double, 3> reach{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    reach[axis] = seen[axis].value_or(known.empty() ? 1 : *std::ranges::max_element(known));
    if (!(reach[axis] >= least && reach[axis] <= most)) return std::nullopt;
  }
  return reach;
}

}  // namespace understudy::spu
