// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/headlight.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "spu/volume/proxy/facing_colours.h"
#include "spu/volume/proxy/gradient_reach.h"
#include "spu/volume/proxy/light_space.h"
#include "spu/volume/proxy/march_table.h"
#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/slope_probe.h"
#include "volume/matrix.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

constexpr int coarse_texels = 16;   ///< of fields that are looked at in many frames
constexpr int angles = 65;          ///< between normal and ray, from 0 to pi
constexpr int responses = 1025;     ///< of volume::Light
constexpr double golden = 2.39996;  ///< radians: turns by it come close to no earlier one for long

const Refusal another_colour{"the light has a colour, or shows slopes in another one than even fields"};

/// What a ray shows of a slope.
struct SeenSlope {
  volume::Vec3 gradient{};    ///< in texture space
  double cosine = 0;          ///< between its normal and the direction to the eye
  std::vector<Tint> tints{};  ///< of the ray's values
};

/// Null where there is nothing to see.
std::optional<SeenSlope> seen_slope(SlopeProbe& slopes, const LitRay& ray, const LightSpace& directions,
                                    double angle, double turn, int texels = slope_texels) {
  const volume::Vec3 gradient = directions.gradient(angle, turn);
  const std::vector<Rgba> shown = slopes.over(ray, gradient, 1, texels);
  if (!std::ranges::all_of(shown, reached)) return std::nullopt;
  return SeenSlope{gradient, std::cos(angle), tints_of(shown)};
}

/// What `light` shows of a slope, value by value, once it is known how far gradients look.
std::vector<Tint> expected_tints(const SlopeProbe& slopes, const LitRay& ray, const volume::RaySteps& steps,
                                 const volume::Light& light, const SeenSlope& seen, int texels = slope_texels) {
  const LightSpace directions(light, ray.way.way);
  const EvenRise rise = slopes.rise(seen.gradient, light.reach, texels);
  std::vector<Tint> tints;
  for (std::size_t v = 0; v < ray.values.size(); ++v) {
    const auto normals = ray_normals(ray.way, steps, slopes.sample_opacity(ray.values[v]), directions, rise);
    tints.push_back(lit_tint(light, normals, tint_of(ray.base[v])));
  }
  return tints;
}

using Matrix = std::array<double, 9>;

/// Spaces in which the program may take gradients or rays: that in which its steps have one length, that in
/// which texels are cubes, and that of the texture.
std::vector<Matrix> light_spaces(const MarchContext& measured, const March& march) {
  std::vector<Matrix> spaces;
  if (!march.steps.between_planes()) spaces.push_back(march.steps.metric);
  Matrix texels{};
  for (std::size_t k = 0; k < 3; ++k) texels[4 * k] = measured.texture.size[k];
  spaces.push_back(texels);
  spaces.push_back({1, 0, 0, 0, 1, 0, 0, 0, 1});
  return spaces;
}

/// `light` in all of them, with gradients and rays in one space first.
std::vector<volume::Light> in_light_spaces(volume::Light light, const std::vector<Matrix>& spaces) {
  std::vector<volume::Light> lights;
  for (const Matrix& space : spaces) {
    light.space = space;
    lights.push_back(light);
  }
  for (const Matrix& space : spaces) {
    for (const Matrix& rays : spaces) {
      if (rays == space) continue;
      light.space = space;
      light.ray_space = rays;
      lights.push_back(light);
    }
  }
  return lights;
}

/// Slopes at a few angles to the eye, each turned about the ray; empty where there is nothing to see.
std::vector<std::vector<SeenSlope>> turned_slopes(SlopeProbe& slopes, const LitRay& ray,
                                                  const volume::Light& light) {
  const LightSpace directions(light, ray.way.way);
  std::vector<std::vector<SeenSlope>> turned;
  for (const double angle : {0.4, 0.8, 1.2, 2.2}) {
    turned.emplace_back();
    for (int i = 0; i < 4; ++i) {
      auto seen = seen_slope(slopes, ray, directions, angle, 0.3 + M_PI / 2 * i);
      if (!seen) return {};
      turned.back().push_back(*std::move(seen));
    }
  }
  return turned;
}

/// How much slopes at one angle differ, in parts of the brightest; 0 where the angle to the eye alone decides.
double difference_when_turned(const std::vector<std::vector<SeenSlope>>& turned) {
  double worst = 0;
  for (const std::vector<SeenSlope>& at_angle : turned) {
    double most = 1e-6;
    double differ = 0;
    for (const SeenSlope& seen : at_angle) {
      most = std::max(most, brightest(seen.tints));
      for (std::size_t v = 0; v < seen.tints.size(); ++v)
        differ = std::max(differ, difference(seen.tints[v], at_angle.front().tints[v]));
    }
    worst = std::max(worst, differ / most);
  }
  return worst;
}

/// What the light makes of the base colours: a multiple of each, and something white.
struct ResponseFit {
  volume::LightResponse response;
  double worst = 0;  ///< by so much does a channel differ from it
};

ResponseFit response_fit(const std::vector<Tint>& base, const std::vector<Tint>& lit) {
  double n = 0;
  double x = 0;
  double y = 0;
  for (std::size_t v = 0; v < base.size(); ++v) {
    for (std::size_t c = 0; c < 3; ++c) {
      x += base[v][c];
      y += lit[v][c];
      ++n;
    }
  }
  x /= n;
  y /= n;
  double xx = 0;
  double xy = 0;
  for (std::size_t v = 0; v < base.size(); ++v) {
    for (std::size_t c = 0; c < 3; ++c) {
      xx += (base[v][c] - x) * (base[v][c] - x);
      xy += (base[v][c] - x) * (lit[v][c] - y);
    }
  }
  // Where all colours are one grey, nothing tells white from it, and nothing needs to.
  constexpr double least_spread = 0.05;
  const bool spread = std::sqrt(xx / n) > least_spread * x;
  const double diffuse = spread ? xy / xx : y / x;
  const double white = spread ? y - diffuse * x : 0;
  ResponseFit fit{{float(diffuse), float(white)}};
  for (std::size_t v = 0; v < base.size(); ++v) {
    for (std::size_t c = 0; c < 3; ++c)
      fit.worst = std::max(fit.worst, std::abs(diffuse * base[v][c] + white - lit[v][c]));
  }
  return fit;
}

/// At cosines, of what is known at angles.
std::vector<volume::LightResponse> by_cosine(const std::vector<volume::LightResponse>& by_angle) {
  std::vector<volume::LightResponse> response;
  for (int i = 0; i < responses; ++i) {
    const double cosine = 2.0 * i / (responses - 1) - 1;
    const double place = std::acos(std::clamp(cosine, -1.0, 1.0)) / M_PI * double(by_angle.size() - 1);
    const std::size_t entry = std::min(std::size_t(place), by_angle.size() - 2);
    const float share = float(place - double(entry));
    const volume::LightResponse &low = by_angle[entry], &high = by_angle[entry + 1];
    response.push_back({low.diffuse + share * (high.diffuse - low.diffuse),
                        low.specular + share * (high.specular - low.specular)});
  }
  return response;
}

/// Whether a slope looks as `light` says.
bool is_explained(const SlopeProbe& slopes, const LitRay& ray, const volume::RaySteps& steps,
                  const volume::Light& light, const SeenSlope& seen, int texels = slope_texels) {
  constexpr double same = 0.02;
  const std::vector<Tint> expected = expected_tints(slopes, ray, steps, light, seen, texels);
  for (std::size_t v = 0; v < expected.size(); ++v) {
    if (!(difference(seen.tints[v], expected[v]) <= same * std::max(1.0, brightest(seen.tints)))) return false;
  }
  return true;
}

/// Whether `ray` shows the light at these angles.
bool shows_light(SlopeProbe& slopes, const LitRay& ray, const volume::RaySteps& steps,
                 const volume::Light& light, std::span<const double> looked_at, int texels) {
  const LightSpace directions(light, ray.way.way);
  return std::ranges::all_of(looked_at, [&](double angle) {
    const auto seen = seen_slope(slopes, ray, directions, angle, 1 + 3 * angle, texels);
    return seen && is_explained(slopes, ray, steps, light, *seen, texels);
  });
}

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

/// Whether neither opacity nor colour depend on how steep a slope is, but for what values on the ray differ by.
/// Beside it a field may rise by much, if not across the face by which the ray enters: half a texel from there
/// it is even.
bool is_the_same_for_any_steepness(SlopeProbe& slopes, const LitRay& ray, const LightSpace& directions,
                                   std::size_t axis_of_entry) {
  constexpr float same_opacity = 0.03F;
  constexpr double same = 0.05;
  constexpr double brighter = 4;  // than the base colours, at most, are slopes taken to be at this angle
  struct Slope {
    volume::Vec3 gradient;
    std::array<double, 3> steepness;  ///< times the least rise that tells
  };
  constexpr double nearly_beside = 1.31;
  volume::Vec3 entry{};
  entry[axis_of_entry] = 1;
  volume::Vec3 beside = volume::cross(ray.way.way, entry);
  if (!(volume::length(beside) > 1e-3 * volume::length(ray.way.way)))
    beside = {entry[1], entry[2], entry[0]};  // any, of a ray straight across the face
  beside = volume::scale(beside, 1 / volume::length(beside));
  for (const Slope& looked_at :
       {Slope{directions.gradient(nearly_beside, 0.7), {1, 0.25, 12}}, Slope{beside, {1, 100, 400}}}) {
    std::vector<Tint> first;
    for (const double steepness : looked_at.steepness) {
      const std::vector<Rgba> shown = slopes.over(ray, looked_at.gradient, steepness);
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

/// How values all over the range, opaque ones too, look in a field that rises across the face by which the ray
/// enters, where even the first sample has the others' normal; and where slopes face the eye and are brightest.
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
  // Values of a ray whose own colours, like those of the values beside them, are seen, and hardly differ.
  const auto is_even = [&](std::size_t i) {
    const auto is_visible = [](const Rgba& colour) { return reached(colour) && colour[3] > least_opacity; };
    if (!std::ranges::all_of(std::span(base).subspan(i - 1, 3), is_visible)) return false;
    const Tint tint = tint_of(base[i]);
    return difference(tint, tint_of(base[i - 1])) <= step && difference(tint, tint_of(base[i + 1])) <= step;
  };
  std::vector<LitValue> lit;
  const auto look_at = [&](const std::vector<Rgba>& shown, const auto& normals_of) {
    for (std::size_t i = 1; i + 1 < values.size(); ++i) {
      if (is_even(i) && reached(shown[i]) && shown[i][3] > least_opacity)
        lit.push_back({tint_of(shown[i]), tint_of(base[i]), normals_of(values[i])});
    }
  };
  const double cosine = directions.cosine_across(axis);
  for (const double side : {1.0, -1.0}) {
    volume::Vec3 gradient{};
    gradient[axis] = side;
    look_at(slopes.over(ray, values, gradient, 1, slopes.fine_texels()), [&](float) {
      return std::vector<NormalShare>{{side * cosine, 1}};
    });
  }
  const volume::Vec3 facing = directions.gradient(0, 0);
  const EvenRise rise = slopes.rise(facing, light.reach);
  look_at(slopes.over(ray, values, facing), [&](float value) {
    return ray_normals(ray.way, steps, slopes.sample_opacity(value), directions, rise);
  });
  return lit;
}

/// The light without and with clamped colours, as far as it explains them all and the other does so no better.
std::vector<volume::Light> as_seen(volume::Light light, const std::vector<LitValue>& values) {
  constexpr double same = 0.05;
  constexpr double least_part = 0.95;
  constexpr double clearly = 0.003;  // better, on average
  std::vector<volume::Light> lights;
  std::vector<double> differences;
  for (const float brightest : {std::numeric_limits<float>::infinity(), 1.0F}) {
    light.brightest = brightest;
    double explained = 0;
    double sum = 0;
    for (const LitValue& value : values) {
      const Tint expected = lit_tint(light, value.normals, value.base);
      const double differ = difference(value.seen, expected);
      explained += differ < same * std::max(1.0, difference(expected, {})) ? 1 : 0;
      sum += differ;
    }
    if (explained < least_part * double(values.size())) continue;
    lights.push_back(light);
    differences.push_back(sum / double(values.size()));
  }
  if (lights.size() == 2 && std::abs(differences[0] - differences[1]) > clearly)
    lights.erase(lights.begin() + (differences[0] > differences[1] ? 0 : 1));
  return lights;
}

/// Of one ray, whatever the others show, going by slopes at `angles` from 0 to pi. What samples at the
/// texture's ends add to it is taken away as the light so far says; without reach it stays.
std::variant<volume::Light, Refusal> light_on(const SlopeProbe& slopes, const LitRay& ray,
                                              const volume::RaySteps& steps, const std::vector<SeenSlope>& seen,
                                              volume::Light light) {
  constexpr double same = 0.03;
  const std::vector<Tint> base = tints_of(ray.base);
  std::vector<volume::LightResponse> by_angle;
  for (const SeenSlope& slope : seen) {
    std::vector<Tint> inside = slope.tints;
    if (!light.response.empty()) {
      const std::vector<Tint> expected = expected_tints(slopes, ray, steps, light, slope);
      for (std::size_t v = 0; v < inside.size(); ++v) {
        const Tint here = lit_tint(light, slope.cosine, base[v]);
        for (std::size_t c = 0; c < 3; ++c) inside[v][c] += here[c] - expected[v][c];
      }
    }
    const ResponseFit fit = response_fit(base, inside);
    if (!(fit.worst <= same * std::max(1.0, brightest(inside)))) return another_colour;
    by_angle.push_back(fit.response);
  }
  // Light that is not seen may be one that wakes on steeper slopes.
  constexpr float visible = 0.02F;
  if (light.even[0] > 0 && std::ranges::all_of(by_angle, [&](const volume::LightResponse& at) {
        return std::abs(at.diffuse - 1) < visible && std::abs(at.specular) < visible;
      }))
    return Refusal{"gradients are taken, but change no colour that is looked at"};
  light.response = by_cosine(by_angle);
  return light;
}

/// The light, and how far its gradients look: each is measured better by the other.
std::variant<volume::Light, Refusal> light_and_reach(SlopeProbe& slopes, const LitRay& ray,
                                                     const volume::RaySteps& steps, volume::Light light) {
  constexpr int rounds = 2;
  constexpr int corrections = 4;
  const LightSpace directions(light, ray.way.way);
  std::vector<SeenSlope> seen;
  for (int i = 0; i < angles; ++i) {
    auto slope = seen_slope(slopes, ray, directions, M_PI * i / (angles - 1), golden * i);
    if (!slope) return Refusal{"fields with a slope show nothing"};
    seen.push_back(*std::move(slope));
  }
  auto found = light_on(slopes, ray, steps, seen, light);
  for (int round = 0; round < rounds; ++round) {
    if (!std::holds_alternative<volume::Light>(found)) return found;
    const auto reach = gradient_reach(slopes, ray, std::get<volume::Light>(found));
    if (!reach) return Refusal{"gradients look farther than eight texels"};
    for (int i = 0; i < corrections && std::holds_alternative<volume::Light>(found); ++i) {
      light = std::get<volume::Light>(found);
      light.reach = *reach;
      found = light_on(slopes, ray, steps, seen, light);
    }
  }
  return found;
}

/// A ray through the middle of the view, with a value that lets half of the light through.
std::optional<LitRay> ray_of_half_seen_value(SlopeProbe& slopes, const RaysThroughBox& rays,
                                             const March& march) {
  const auto middle = rays.middle();
  const auto way = rays.through(middle[0], middle[1]);
  const auto value = way ? half_seen_value(march, way->way) : std::nullopt;
  if (!value) return std::nullopt;
  LitRay ray{middle[0], middle[1], *way, {*value}};
  ray.base = slopes.base(ray.x, ray.y, ray.values);
  return ray;
}

/// Long rays on which values are translucent.
std::vector<LitRay> lit_rays(SlopeProbe& slopes, const RaysThroughBox& rays, const volume::RaySteps& steps) {
  std::vector<LitRay> seen;
  for (LitRay& ray : long_rays(rays, steps)) {
    LitRay with = slopes.with_values(std::move(ray));
    if (!with.values.empty()) seen.push_back(std::move(with));
  }
  return seen;
}

}  // namespace

std::variant<std::vector<volume::Light>, Refusal> measure_headlight(const MarchContext& measured,
                                                                    FieldProbe& probe, const ProxyBox& box,
                                                                    March& march) {
  constexpr double darkest = 1e-3;
  constexpr double differ_in_another_space = 0.3;
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  volume::Light light;
  light.ambient = {0, 0, 0};
  light.diffuse = light.specular = {1, 1, 1};
  SlopeProbe slopes(measured, probe, march);
  std::vector<LitRay> seen = lit_rays(slopes, rays, march.steps);
  if (seen.empty()) return Refusal{"no value is translucent on a long ray: light cannot be measured"};
  if (!(brightest(tints_of(seen.front().base)) > darkest)) {
    light.even = {0, 0, 0};
    march.light = light;
    take_facing_colours(measured, probe, box, march);
    seen = lit_rays(slopes, rays, march.steps);
    if (seen.empty() || !(brightest(tints_of(seen.front().base)) > darkest))
      return Refusal{"neither even fields nor slopes have a colour under the light"};
  }
  const LitRay& ray = seen.front();
  double least = differ_in_another_space;
  std::vector<std::vector<SeenSlope>> turned;
  for (const volume::Light& in_space : in_light_spaces(light, light_spaces(measured, march))) {
    auto slopes_there = turned_slopes(slopes, ray, in_space);
    const double differ = difference_when_turned(slopes_there);
    if (slopes_there.empty() || !(differ < least)) continue;
    least = differ;
    light = in_space;
    turned = std::move(slopes_there);
  }
  if (turned.empty()) return Refusal{"the light does not shine from the eye"};
  const std::size_t axis = axis_of_entry(box.region, ray.way);
  if (!is_the_same_for_any_steepness(slopes, ray, LightSpace(light, ray.way.way), axis))
    return Refusal{"colour or opacity depend on how steep a gradient is"};
  auto found = light_and_reach(slopes, ray, march.steps, light);
  if (auto* const refusal = std::get_if<Refusal>(&found)) return std::move(*refusal);
  light = std::get<volume::Light>(std::move(found));
  const auto looks_as_said = [&](const SeenSlope& slope) {
    return is_explained(slopes, ray, march.steps, light, slope);
  };
  if (!std::ranges::all_of(turned,
                           [&](const auto& at_angle) { return std::ranges::all_of(at_angle, looks_as_said); }))
    return Refusal{"the light does not shine from the eye"};
  constexpr std::array<double, 4> looked_at{0.2, 0.9, 1.5, 2.6};
  for (const LitRay& other : std::span(seen).subspan(1)) {
    if (!shows_light(slopes, other, march.steps, light, looked_at, slope_texels))
      return Refusal{"the light does not shine along every ray"};
  }
  auto lights = as_seen(light, lit_values(slopes, ray, march.steps, axis, light, measured.range));
  if (lights.empty()) return another_colour;
  return lights;
}

bool still_lit(const MarchContext& measured, FieldProbe& probe, const ProxyBox& box, const March& march) {
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  SlopeProbe slopes(measured, probe, march);
  const auto ray = ray_of_half_seen_value(slopes, rays, march);
  if (!ray) return !rays.way(rays.middle()[0], rays.middle()[1]);
  constexpr std::array looked_at{0.3, 1.2};
  return is_translucent(ray->base.front()) &&
         shows_light(slopes, *ray, march.steps, *march.light, looked_at, coarse_texels);
}

bool gradients_still_reach(const MarchContext& measured, FieldProbe& probe, const ProxyBox& box,
                           const March& march) {
  constexpr double same = 0.1;  // of a texel
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  SlopeProbe slopes(measured, probe, march);
  const auto ray = ray_of_half_seen_value(slopes, rays, march);
  if (!ray || !is_translucent(ray->base.front())) return false;
  const auto reach = gradient_reach(slopes, *ray, *march.light);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!reach || std::abs((*reach)[axis] - march.light->reach[axis]) > same) return false;
  }
  return true;
}

}  // namespace understudy::spu
