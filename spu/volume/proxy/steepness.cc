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

/// Returns a gradient perpendicular to a ray, and parallel to the face by which it enters (within half a texel
/// of the face, a field is constant). Such a field may rise by much.
volume::Vec3 beside(const volume::Vec3& way, std::size_t axis_of_entry) {
  volume::Vec3 entry{};
  entry[axis_of_entry] = 1;
  const volume::Vec3 square = volume::cross(way, entry);
  const double length = volume::length(square);
  // For a ray perpendicular to the face, any gradient in the face will do.
  if (!(length > 1e-3 * volume::length(way))) return {entry[1], entry[2], entry[0]};
  return volume::scale(square, 1 / length);
}

/// A gradient, and the multiples of the least rise by which it is probed.
struct Slope {
  volume::Vec3 gradient;
  std::array<double, 3> steepness;
};

/// Returns slopes nearly perpendicular to the ray, as steep as its colours allow, and slopes perpendicular to
/// it, much steeper, as values on the ray hardly differ there.
std::array<Slope, 2> slopes_aside(const SlopeProbe& slopes, const LitRay& ray, const LightSpace& directions,
                                  std::size_t axis_of_entry) {
  const double measured = slopes.steepness();
  return {{{directions.gradient(nearly_beside, 0.7), {measured, 0.25 * measured, std::max(12.0, measured)}},
           {beside(ray.way.way, axis_of_entry), {measured, 100, 400}}}};
}

/// Whether slopes that face the eye look like slopes a quarter as steep. What a guard against a division by
/// zero takes from a normal's length shrinks as slopes get steeper: the light that is measured is wrong by at
/// most a third of what is allowed here.
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

/// Whether a slope has the opacity of values nearby, and these colours, up to what values on the ray differ by.
bool is_as_expected(SlopeProbe& slopes, const LitRay& ray, const volume::Vec3& gradient, double steepness,
                    const std::vector<Rgba>& shown, const std::vector<Tint>& expected) {
  constexpr float same_opacity = 0.03F;
  constexpr double same = 0.05;
  constexpr double brighter = 4;  // times the base colours: the most that slopes at this angle are taken for
  const std::vector<BaseNearby> base = base_nearby(slopes, ray, slopes.rise_along(ray, gradient, steepness));
  const std::vector<Tint> tints = tints_of(shown);
  for (std::size_t v = 0; v < shown.size(); ++v) {
    if (!(shown[v][3] > base[v].least_opacity - same_opacity &&
          shown[v][3] < base[v].most_opacity + same_opacity))
      return false;
    if (!(difference(tints[v], expected[v]) <=
          same * std::max(1.0, brightest(expected)) + brighter * base[v].spread))
      return false;
  }
  return true;
}

}  // namespace

bool is_the_same_for_any_steepness(SlopeProbe& slopes, const LitRay& ray, const LightSpace& directions,
                                   std::size_t axis_of_entry) {
  if (!faces_alike_when_gentler(slopes, ray, directions)) return false;
  for (const Slope& aside : slopes_aside(slopes, ray, directions, axis_of_entry)) {
    std::vector<Tint> first;
    for (const double steepness : aside.steepness) {
      const std::vector<Rgba> shown = slopes.over(ray, ray.values, aside.gradient, steepness);
      if (first.empty()) first = tints_of(shown);
      if (!is_as_expected(slopes, ray, aside.gradient, steepness, shown, first)) return false;
    }
  }
  return true;
}

bool is_lit_as_said_for_any_steepness(SlopeProbe& slopes, const LitRay& ray, const volume::RaySteps& steps,
                                      const volume::Light& light, std::size_t axis_of_entry) {
  const LightSpace directions(light, ray.way.way);
  const std::vector<Tint> base = tints_of(ray.base);
  for (const Slope& aside : slopes_aside(slopes, ray, directions, axis_of_entry)) {
    for (const double steepness : aside.steepness) {
      const EvenRise rise = slopes.rise(aside.gradient, steepness, light.reach);
      std::vector<Tint> expected;
      for (std::size_t v = 0; v < base.size(); ++v) {
        const auto opacities = slopes.opacities_over(ray, ray.values[v], aside.gradient, steepness);
        const auto normals = ray_normals(ray.way, steps, opacities, directions, rise, light.guard);
        expected.push_back(lit_tint(light, normals, base[v]));
      }
      const std::vector<Rgba> shown = slopes.over(ray, ray.values, aside.gradient, steepness);
      if (!is_as_expected(slopes, ray, aside.gradient, steepness, shown, expected)) return false;
    }
  }
  return true;
}

}  // namespace understudy::spu
