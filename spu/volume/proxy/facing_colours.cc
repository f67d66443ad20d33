// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/facing_colours.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "spu/volume/proxy/light_space.h"
#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/slope_probe.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

/// By so much of SlopeProbe's least rise: less than from entry to entry of the table.
constexpr double flat = 0.1;

struct FacingColours {
  std::vector<Rgba> colours;  ///< of the table's values
  double cosine = 1;  ///< between the slopes' normal and the direction to the eye, from the side that is lit

  double brightness() const {
    double sum = 0;
    for (const Rgba& colour : colours) sum += reached(colour) ? double(brightest_channel(colour)) : 0;
    return sum;
  }
};

/// The base colour that `light` shows so, over its opacity.
Tint unlit(const volume::Light& light, double cosine, const Tint& lit) {
  constexpr double darkest = 1e-3;
  const Tint white = lit_tint(light, cosine, {0, 0, 0});
  const Tint one = lit_tint(light, cosine, {1, 1, 1});
  Tint base{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double diffuse = one[c] - white[c];
    if (diffuse > darkest) base[c] = std::max(0.0, (lit[c] - white[c]) / diffuse);
  }
  return base;
}

}  // namespace

std::size_t axis_of_entry(const volume::Box& region, const WayThroughBox& way) {
  std::size_t nearest = 0;
  const auto distance = [&](std::size_t axis) {
    return std::min(std::abs(way.entry[axis] - region.low[axis]),
                    std::abs(way.entry[axis] - region.high[axis]));
  };
  for (std::size_t axis = 1; axis < 3; ++axis) {
    if (distance(axis) < distance(nearest)) nearest = axis;
  }
  return nearest;
}

void take_facing_colours(const MarchContext& measured, FieldProbe& probe, const ProxyBox& box, March& march) {
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  const auto middle = rays.middle();
  const auto way = rays.through(middle[0], middle[1]);
  if (!way) return;
  auto& entries = march.table.entries;
  const LitRay ray{middle[0], middle[1], *way,
                   values_over({march.table.low, march.table.high}, int(entries.size()))};
  const std::size_t axis = axis_of_entry(box.region, *way);
  SlopeProbe slopes(measured, probe, march);
  FacingColours facing;
  // Some programs' normals point to where the field rises, and one side may be dark.
  for (const double side : {1.0, -1.0}) {
    volume::Vec3 gradient{};
    gradient[axis] = std::copysign(side, side * way->way[axis]);
    FacingColours seen{slopes.over(ray, gradient, flat, slopes.fine_texels())};
    if (!march.light->response.empty()) seen.cosine = LightSpace(*march.light, way->way).cosine(gradient);
    if (facing.colours.empty() || seen.brightness() > facing.brightness()) facing = std::move(seen);
  }
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const Rgba& colour = facing.colours[i];
    if (!reached(colour) || !(colour[3] > 0)) continue;
    Tint tint = tint_of(colour);
    if (!march.light->response.empty()) tint = unlit(*march.light, facing.cosine, tint);
    for (std::size_t c = 0; c < 3; ++c) entries[i][c] = float(tint[c] * double(entries[i][3]));
  }
}

}  // namespace understudy::spu
