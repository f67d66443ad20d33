// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/gradient_reach.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "spu/volume/proxy/light_space.h"

namespace understudy::spu {

/// Over stripes of nearly one value, samples with another stripe within their reach are lit.
std::optional<double> gradient_reach_along(SlopeProbe& slopes, const LitRay& ray, const volume::Light& light,
                                           std::size_t axis) {
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
  const double contrast = lit[channel] - plain[channel];
  if (std::abs(contrast) < tells) return std::nullopt;
  const auto reach_by = [&](int width) {
    const double part = (slopes.over_stripes(ray, axis, width)[channel] - plain[channel]) / contrast;
    return part * width * FieldProbe::split_unit / 2;
  };
  // Narrow stripes measure a short reach better, but none beyond a quarter of their width.
  constexpr int wide = 64;
  constexpr int narrow = 16;
  double reach = reach_by(wide);
  if (reach < narrow * FieldProbe::split_unit / 4) reach = reach_by(narrow);
  const double texels = slopes.reach_in_stripes(axis, reach);
  // Round to half texels where the error of counting samples permits.
  const double halves = std::round(2 * texels) / 2;
  return halves >= 1 && std::abs(texels - halves) < 0.1 ? halves : texels;
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
