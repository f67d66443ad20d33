// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/facing_colours.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "spu/volume/classification/table_lookup.h"
#include "spu/volume/proxy/light_space.h"
#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/slope_probe.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

/// In units of SlopeProbe's least rise: about the difference between neighbouring entries of the table. In
/// programs that keep normals from a division by zero, gentler slopes have shorter normals
/// (SlopeProbe::over_steep).
constexpr double gentle = 1;

/// Colours over a field that rises perpendicularly to the face by which a ray enters, in one direction.
struct FacingColours {
  std::vector<Rgba> colours;  ///< by value
  double cosine = 1;          ///< between the slopes' normal and the direction to the eye

  double brightness() const {
    double sum = 0;
    for (const Rgba& colour : colours) sum += reached(colour) ? double(brightest_channel(colour)) : 0;
    return sum;
  }
};

/// Returns the colours for the brighter of both directions: in some programs, normals point to where the field
/// rises. Uses the ray through the middle of the view; empty if there is none.
FacingColours facing_colours(const MarchContext& measured, FieldProbe& probe, const ProxyBox& box,
                             const March& march, const std::vector<float>& values) {
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  const auto middle = rays.middle();
  const auto way = rays.through(middle[0], middle[1]);
  if (!way) return {};
  const LitRay ray{middle[0], middle[1], *way, values};
  const std::size_t axis = axis_of_entry(box.region, *way);
  SlopeProbe slopes(measured, probe, march);
  FacingColours facing;
  for (const double side : {1.0, -1.0}) {
    volume::Vec3 gradient{};
    gradient[axis] = std::copysign(side, side * way->way[axis]);
    FacingColours seen{slopes.over(ray, ray.values, gradient, gentle, slopes.fine_texels())};
    if (!march.light->response.empty()) seen.cosine = LightSpace(*march.light, way->way).cosine(gradient);
    if (facing.colours.empty() || seen.brightness() > facing.brightness()) facing = std::move(seen);
  }
  return facing;
}

/// Returns the base colour, over its opacity, that `light` shows as `lit`; null if brighter ones would look
/// alike.
std::optional<Tint> unlit(volume::Light light, double cosine, const Tint& lit) {
  constexpr double darkest = 1e-3;
  constexpr double rounding = 0.01;
  if (difference(lit, {}) > double(light.brightest) - rounding) return std::nullopt;
  light.brightest = std::numeric_limits<float>::infinity();
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

bool take_facing_colours(const MarchContext& measured, FieldProbe& probe, const ProxyBox& box, March& march) {
  auto& entries = march.table.entries;
  const FacingColours facing = facing_colours(
      measured, probe, box, march, values_over({march.table.low, march.table.high}, int(entries.size())));
  if (facing.colours.empty()) return false;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const Rgba& colour = facing.colours[i];
    if (!reached(colour) || !(colour[3] > 0)) continue;
    std::optional<Tint> tint = tint_of(colour);
    if (!march.light->response.empty()) tint = unlit(*march.light, facing.cosine, *tint);
    if (!tint) return false;
    for (std::size_t c = 0; c < 3; ++c) entries[i][c] = float((*tint)[c] * double(entries[i][3]));
  }
  return true;
}

bool shows_facing_colours(const MarchContext& measured, FieldProbe& probe, const ProxyBox& box,
                          const March& march, const std::vector<float>& values) {
  constexpr double same = 0.03;
  constexpr float least_opacity = 0.08F;
  const FacingColours facing = facing_colours(measured, probe, box, march, values);
  for (std::size_t i = 0; i < facing.colours.size(); ++i) {
    const Rgba sample = table_at(march.table, values[i]);
    const Rgba& colour = facing.colours[i];
    if (!(sample[3] > 0) || !reached(colour) || !(colour[3] > least_opacity)) continue;
    const Tint expected = lit_tint(*march.light, facing.cosine, tint_of(sample));
    if (!(difference(tint_of(colour), expected) <= same * std::max(1.0, difference(expected, {}))))
      return false;
  }
  return true;
}

}  // namespace understudy::spu
