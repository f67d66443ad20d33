// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/steepness.h"

#include <algorithm>
#include <array>
#include <vector>

#include "volume/matrix.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

constexpr double nearly_beside = 1.31;  ///< radians between normal and ray

/// The base colours of a value and of others nearby.
struct BaseNearby {
  float least_opacity = 1;
  float most_opacity = 0;
  double spread = 0;  ///< of tints
};

std::vector<BaseNearby> base_nearby(SlopeProbe& slopes, const LitRay& ray, float away) {
  std::vector<BaseNearby> nearby;
  for (std::size_t v = 0; v < ray.values.size(); ++v) {
    BaseNearby around;
    const Tint tint = tint_of(ray.base[v]);
    std::vector<float> values;
    for (const float part : {-1.0F, -0.5F, 0.0F, 0.5F, 1.0F}) values.push_back(ray.values[v] + part * away);
    for (const Rgba& colour : slopes.base(ray.x, ray.y, values)) {
      around.least_opacity = std::min(around.least_opacity, colour[3]);
      around.most_opacity = std::max(around.most_opacity, colour[3]);
      if (colour[3] > 0) around.spread = std::max(around.spread, difference(tint, tint_of(colour)));
    }
    nearby.push_back(around);
  }
  return nearby;
}

/// A gradient square to a ray, and not across the face by which it enters: half a texel from there a field is
/// even. Such a field may rise by much.
volume::Vec3 beside(const volume::Vec3& way, std::size_t axis_of_entry) {
  volume::Vec3 entry{};
  entry[axis_of_entry] = 1;
  const volume::Vec3 square = volume::cross(way, entry);
  const double length = volume::length(square);
  // Any will do for a ray straight across the face.
  if (!(length > 1e-3 * volume::length(way))) return {entry[1], entry[2], entry[0]};
  return volume::scale(square, 1 / length);
}

/// Whether slopes that face the eye show what slopes a quarter as steep do. What a guard against a division by
/// zero takes from a normal's length shrinks as slopes get steeper: by a third of what is allowed here, at
/// most, is the light wrong that is measured.
bool faces_alike_when_gentler(SlopeProbe& slopes, const LitRay& ray, const LightSpace& directions) {
  constexpr double same = 0.05;
  const volume::Vec3 facing = directions.gradient(0, 0);
  const auto tints_at = [&](double steepness) {
    return tints_of(slopes.over(ray, ray.values, facing, steepness));
  };
  const std::vector<Tint> measured = tints_at(slopes.steepness());
  const std::vector<Tint> gentler = tints_at(slopes.steepness() / 4);
  for (std::size_t v = 0; v < measured.size(); ++v) {
    if (!(difference(measured[v], gentler[v]) <= same)) return false;
  }
  return true;
}

}  // namespace

bool is_the_same_for_any_steepness(SlopeProbe& slopes, const LitRay& ray, const LightSpace& directions,
                                   std::size_t axis_of_entry) {
  constexpr float same_opacity = 0.03F;
  constexpr double same = 0.05;
  constexpr double brighter = 4;  // than the base colours, at most, are slopes taken to be at this angle
  struct Slope {
    volume::Vec3 gradient;
    std::array<double, 3> steepness;  ///< times the least rise that tells
  };
  if (!faces_alike_when_gentler(slopes, ray, directions)) return false;
  const double measured = slopes.steepness();
  for (const Slope& looked_at :
       {Slope{directions.gradient(nearly_beside, 0.7), {measured, 0.25 * measured, std::max(12.0, measured)}},
        Slope{beside(ray.way.way, axis_of_entry), {measured, 100, 400}}}) {
    std::vector<Tint> first;
    for (const double steepness : looked_at.steepness) {
      const std::vector<Rgba> shown = slopes.over(ray, ray.values, looked_at.gradient, steepness);
      const std::vector<BaseNearby> base =
          base_nearby(slopes, ray, slopes.rise_along(ray, looked_at.gradient, steepness));
      const std::vector<Tint> tints = tints_of(shown);
      if (first.empty()) first = tints;
      for (std::size_t v = 0; v < shown.size(); ++v) {
        if (!(shown[v][3] > base[v].least_opacity - same_opacity &&
              shown[v][3] < base[v].most_opacity + same_opacity))
          return false;
        if (difference(tints[v], first[v]) > same * std::max(1.0, brightest(first)) + brighter * base[v].spread)
          return false;
      }
    }
  }
  return true;
}

}  // namespace understudy::spu
