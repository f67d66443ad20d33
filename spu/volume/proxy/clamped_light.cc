// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/clamped_light.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "spu/volume/proxy/light_space.h"
#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/ray_normals.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

/// One value, possibly an opaque one, in a field that rises perpendicularly to the face by which the ray
/// enters, where even the first sample has the same normal as the others, or on slopes that face the eye and
/// are brightest.
struct LitValue {
  Tint seen;
  Tint base;
  std::vector<NormalShare> normals;
};

std::vector<LitValue> lit_values(SlopeProbe& slopes, const LitRay& ray, const volume::RaySteps& steps,
                                 std::size_t axis, const volume::Light& light,
                                 const std::array<float, 2>& range) {
  constexpr double step = 0.05;
  constexpr int count = 64;
  constexpr float least_opacity = 0.08F;
  const std::vector<float> values = values_over(range, count);
  const std::vector<Rgba> base = slopes.base(ray.x, ray.y, values);
  const LightSpace directions(light, ray.way.way);
  // Whether a value and its neighbours in the list are visible and have nearly the same colour.
  const auto is_even = [&](std::size_t i) {
    const auto is_visible = [](const Rgba& colour) { return reached(colour) && colour[3] > least_opacity; };
    if (!std::ranges::all_of(std::span(base).subspan(i - 1, 3), is_visible)) return false;
    const Tint tint = tint_of(base[i]);
    return difference(tint, tint_of(base[i - 1])) <= step && difference(tint, tint_of(base[i + 1])) <= step;
  };
  std::vector<LitValue> lit;
  const auto look_at = [&](const volume::Vec3& gradient, const std::vector<Rgba>& shown,
                           const auto& normals_of) {
    for (std::size_t i = 1; i + 1 < values.size(); ++i) {
      if (is_even(i) && slopes.allows_steep(ray, values[i], gradient) && reached(shown[i]) &&
          shown[i][3] > least_opacity)
        lit.push_back({tint_of(shown[i]), tint_of(base[i]), normals_of(values[i])});
    }
  };
  const double cosine = directions.cosine_across(axis);
  const auto rise_of = [&](const volume::Vec3& gradient, float value, int texels) {
    return slopes.rise(gradient, slopes.steepness_over(ray, value, gradient), light.reach, texels);
  };
  for (const double side : {1.0, -1.0}) {
    volume::Vec3 gradient{};
    gradient[axis] = side;
    const int texels = slopes.fine_texels();
    look_at(gradient, slopes.over_steep(ray, values, gradient, texels), [&](float value) {
      const double slope = directions.slope(rise_of(gradient, value, texels).gradient);
      return std::vector<NormalShare>{{side * cosine * light.guard.length_of_normal(slope), 1}};
    });
  }
  const volume::Vec3 facing = directions.gradient(0, 0);
  look_at(facing, slopes.over_steep(ray, values, facing), [&](float value) {
    return ray_normals(ray.way, steps, slopes.opacities_over_steep(ray, value, facing), directions,
                       rise_of(facing, value, slope_texels), light.guard);
  });
  return lit;
}

/// How well a light explains values.
struct Explanation {
  bool is_one = false;  ///< the light explains nearly all values
  double differ = 0;    ///< summed error over the values that the other light would show differently
};

Explanation explanation(const volume::Light& light, const volume::Light& other,
                        const std::vector<LitValue>& values) {
  constexpr double same = 0.05;
  constexpr double least_part = 0.95;
  constexpr double otherwise = 0.01;
  Explanation found;
  double explained = 0;
  for (const LitValue& value : values) {
    const Tint expected = lit_tint(light, value.normals, value.base);
    const double differ = difference(value.seen, expected);
    explained += differ < same * std::max(1.0, difference(expected, {})) ? 1 : 0;
    if (difference(expected, lit_tint(other, value.normals, value.base)) > otherwise) found.differ += differ;
  }
  found.is_one = explained >= least_part * double(values.size());
  return found;
}

}  // namespace

std::vector<volume::Light> without_and_with_clamp(SlopeProbe& slopes, const LitRay& ray,
                                                  const volume::RaySteps& steps, std::size_t axis_of_entry,
                                                  const volume::Light& light,
                                                  const std::array<float, 2>& range) {
  const std::vector<LitValue> values = lit_values(slopes, ray, steps, axis_of_entry, light, range);
  volume::Light clamped = light;
  clamped.brightest = 1;
  const Explanation without = explanation(light, clamped, values);
  const Explanation with = explanation(clamped, light, values);
  constexpr double clearly = 0.7;
  std::vector<volume::Light> lights;
  if (without.is_one && !(with.is_one && with.differ < clearly * without.differ)) lights.push_back(light);
  if (with.is_one && !(without.is_one && without.differ < clearly * with.differ)) lights.push_back(clamped);
  return lights;
}

}  // namespace understudy::spu
