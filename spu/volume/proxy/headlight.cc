// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/headlight.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "spu/volume/proxy/gradient_reach.h"
#include "spu/volume/proxy/light_space.h"
#include "spu/volume/proxy/march_table.h"
#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/slope_probe.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

constexpr int coarse_texels = 16;   ///< of fields that are looked at in many frames
constexpr int fine_texels = 2048;   ///< of fields that rise along one axis
constexpr int angles = 65;          ///< between normal and ray, from 0 to pi
constexpr int responses = 1025;     ///< of volume::Light
constexpr double golden = 2.39996;  ///< radians: turns by it come close to no earlier one for long

const Refusal another_colour{"the light has a colour, or shows slopes in another one than even fields"};

/// Spaces in which the program may measure angles: that in which its steps have one length, and that in which
/// texels are cubes.
std::vector<std::array<double, 9>> light_spaces(const MarchContext& measured, const March& march) {
  std::vector<std::array<double, 9>> spaces;
  if (!march.steps.between_planes()) spaces.push_back(march.steps.metric);
  std::array<double, 9> texels{};
  for (std::size_t k = 0; k < 3; ++k) texels[4 * k] = measured.texture.size[k];
  spaces.push_back(texels);
  return spaces;
}

/// Whether in this space the angle to the eye alone decides.
bool is_round(SlopeProbe& slopes, const LitRay& ray, const std::array<double, 9>& space) {
  constexpr double same = 0.03;
  const LightSpace directions(space, ray.way.way);
  for (const double angle : {0.4, 0.8, 1.2, 2.2}) {
    std::vector<std::vector<Tint>> turned;
    double most = 0;
    for (int i = 0; i < 4; ++i) {
      const std::vector<Rgba> shown = slopes.over(ray, directions.gradient(angle, 0.3 + M_PI / 2 * i));
      if (!std::ranges::all_of(shown, reached)) return false;
      turned.push_back(tints_of(shown));
      most = std::max(most, brightest(turned.back()));
    }
    for (const auto& other : turned) {
      for (std::size_t v = 0; v < other.size(); ++v) {
        if (difference(other[v], turned.front()[v]) > same * most) return false;
      }
    }
  }
  return true;
}

/// What the light makes of colours that even fields have: a multiple of each, and something white.
struct ResponseFit {
  volume::LightResponse response;
  double worst = 0;  ///< by so much does a channel differ from it
};

ResponseFit response_fit(const std::vector<Tint>& even, const std::vector<Tint>& lit) {
  double n = 0;
  double x = 0;
  double y = 0;
  for (std::size_t v = 0; v < even.size(); ++v) {
    for (std::size_t c = 0; c < 3; ++c) {
      x += even[v][c];
      y += lit[v][c];
      ++n;
    }
  }
  x /= n;
  y /= n;
  double xx = 0;
  double xy = 0;
  for (std::size_t v = 0; v < even.size(); ++v) {
    for (std::size_t c = 0; c < 3; ++c) {
      xx += (even[v][c] - x) * (even[v][c] - x);
      xy += (even[v][c] - x) * (lit[v][c] - y);
    }
  }
  // Where all colours are one grey, nothing tells white from it, and nothing needs to.
  constexpr double least_spread = 0.05;
  const bool spread = std::sqrt(xx / n) > least_spread * x;
  const double diffuse = spread ? xy / xx : y / x;
  const double white = spread ? y - diffuse * x : 0;
  ResponseFit fit{{float(diffuse), float(white)}};
  for (std::size_t v = 0; v < even.size(); ++v) {
    for (std::size_t c = 0; c < 3; ++c)
      fit.worst = std::max(fit.worst, std::abs(diffuse * even[v][c] + white - lit[v][c]));
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

/// Whether `ray`, whose even colours are known, shows the light at these angles.
bool shows_light(SlopeProbe& slopes, const LitRay& ray, const volume::Light& light,
                 std::span<const double> looked_at, int texels) {
  constexpr double same = 0.05;
  const LightSpace directions(light.space, ray.way.way);
  const std::vector<Tint> even = tints_of(ray.even);
  for (const double angle : looked_at) {
    const std::vector<Rgba> shown = slopes.over(ray, directions.gradient(angle, 1 + 3 * angle), 1, texels);
    if (!std::ranges::all_of(shown, reached)) return false;
    const std::vector<Tint> lit = tints_of(shown);
    for (std::size_t v = 0; v < lit.size(); ++v) {
      const Tint expected = lit_tint(light, std::cos(angle), even[v]);
      if (difference(lit[v], expected) > same * std::max(1.0, brightest(lit))) return false;
    }
  }
  return true;
}

/// What even fields of a value, and of others nearby, show.
struct EvenNearby {
  float least_opacity = 1;
  float most_opacity = 0;
  double spread = 0;  ///< of tints
};

std::vector<EvenNearby> even_nearby(SlopeProbe& slopes, const LitRay& ray, float away) {
  std::vector<EvenNearby> nearby;
  for (std::size_t v = 0; v < ray.values.size(); ++v) {
    EvenNearby around;
    const Tint tint = tint_of(ray.even[v]);
    for (const Rgba& colour :
         slopes.even(ray.x, ray.y, {ray.values[v] - away, ray.values[v], ray.values[v] + away})) {
      around.least_opacity = std::min(around.least_opacity, colour[3]);
      around.most_opacity = std::max(around.most_opacity, colour[3]);
      if (colour[3] > 0) around.spread = std::max(around.spread, difference(tint, tint_of(colour)));
    }
    nearby.push_back(around);
  }
  return nearby;
}

/// Whether neither opacity nor colour depend on how steep a slope is, but for what values on the ray differ by.
/// Beside it a field may rise by much.
bool is_the_same_for_any_steepness(SlopeProbe& slopes, const LitRay& ray, const LightSpace& directions) {
  constexpr float same_opacity = 0.03F;
  constexpr double same = 0.05;
  constexpr double brighter = 4;  // than in even fields, at most, colours are taken to be at this angle
  struct Slope {
    double angle;
    std::array<double, 3> steepness;  ///< times `rise`
  };
  for (const Slope& looked_at : {Slope{1.31, {1, 0.25, 12}}, Slope{M_PI / 2, {1, 100, 400}}}) {
    std::vector<Tint> first;
    for (const double steepness : looked_at.steepness) {
      const std::vector<Rgba> shown = slopes.over(ray, directions.gradient(looked_at.angle, 0.7), steepness);
      const std::vector<EvenNearby> even =
          even_nearby(slopes, ray, slopes.rise_along(steepness * std::cos(looked_at.angle)));
      const std::vector<Tint> tints = tints_of(shown);
      if (first.empty()) first = tints;
      for (std::size_t v = 0; v < shown.size(); ++v) {
        if (!(shown[v][3] > even[v].least_opacity - same_opacity &&
              shown[v][3] < even[v].most_opacity + same_opacity))
          return false;
        if (difference(tints[v], first[v]) > same * std::max(1.0, brightest(first)) + brighter * even[v].spread)
          return false;
      }
    }
  }
  return true;
}

/// By which of the box's faces the ray enters: the axis across it.
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

/// How values all over the range, opaque ones too, look in a field that rises across the face by which the ray
/// enters; there even the first sample has the others' normal.
struct LitValue {
  Tint seen;
  Tint expected;  ///< if no colour is clamped
};

std::vector<LitValue> lit_values(SlopeProbe& slopes, const LitRay& ray, std::size_t axis,
                                 const volume::Light& light, const std::array<float, 2>& range) {
  constexpr double step = 0.05;
  constexpr int count = 64;
  constexpr float least_opacity = 0.08F;
  const std::vector<float> values = values_over(range, count);
  const std::vector<Rgba> even = slopes.even(ray.x, ray.y, values);
  const double cosine = LightSpace(light.space, ray.way.way).cosine_across(axis);
  std::vector<LitValue> lit;
  for (const double side : {1.0, -1.0}) {
    volume::Vec3 gradient{};
    gradient[axis] = side;
    const std::vector<Rgba> shown = slopes.over(ray, values, gradient, 1, fine_texels);
    for (std::size_t i = 1; i + 1 < values.size(); ++i) {
      const auto is_visible = [](const Rgba& colour) { return reached(colour) && colour[3] > least_opacity; };
      if (!is_visible(even[i - 1]) || !is_visible(even[i]) || !is_visible(even[i + 1]) || !is_visible(shown[i]))
        continue;
      const Tint tint = tint_of(even[i]);
      if (difference(tint, tint_of(even[i - 1])) > step || difference(tint, tint_of(even[i + 1])) > step)
        continue;
      lit.push_back({tint_of(shown[i]), lit_tint(light, side * cosine, tint)});
    }
  }
  return lit;
}

/// The light without and with clamped colours, as far as it explains them all.
std::vector<volume::Light> as_seen(volume::Light light, const std::vector<LitValue>& values) {
  constexpr double same = 0.05;
  constexpr double least_part = 0.95;
  std::vector<volume::Light> lights;
  for (const float brightest : {std::numeric_limits<float>::infinity(), 1.0F}) {
    const auto is_explained = [&](const LitValue& value) {
      Tint expected = value.expected;
      for (double& channel : expected) channel = std::min(channel, double(brightest));
      return difference(value.seen, expected) < same * std::max(1.0, difference(expected, {}));
    };
    if (double(std::ranges::count_if(values, is_explained)) < least_part * double(values.size())) continue;
    light.brightest = brightest;
    lights.push_back(light);
  }
  return lights;
}

/// Of one ray, whatever the others show.
std::variant<volume::Light, Refusal> light_on(SlopeProbe& slopes, const LitRay& ray,
                                              const std::array<double, 9>& space) {
  constexpr double same = 0.03;
  volume::Light light;
  light.space = space;
  light.ambient = {0, 0, 0};
  light.diffuse = light.specular = {1, 1, 1};
  const LightSpace directions(space, ray.way.way);
  const std::vector<Tint> even = tints_of(ray.even);
  std::vector<volume::LightResponse> by_angle;
  for (int i = 0; i < angles; ++i) {
    const std::vector<Rgba> shown = slopes.over(ray, directions.gradient(M_PI * i / (angles - 1), golden * i));
    if (!std::ranges::all_of(shown, reached)) return Refusal{"fields with a slope show nothing"};
    const std::vector<Tint> lit = tints_of(shown);
    const ResponseFit fit = response_fit(even, lit);
    if (!(fit.worst <= same * std::max(1.0, brightest(lit)))) return another_colour;
    by_angle.push_back(fit.response);
  }
  // Light that is not seen may be one that wakes on steeper slopes.
  constexpr float seen = 0.02F;
  if (std::ranges::all_of(by_angle, [&](const volume::LightResponse& at) {
        return std::abs(at.diffuse - 1) < seen && std::abs(at.specular) < seen;
      }))
    return Refusal{"gradients are taken, but change no colour that is looked at"};
  light.response = by_cosine(by_angle);
  return light;
}

}  // namespace

std::variant<std::vector<volume::Light>, Refusal> measure_headlight(const MarchContext& measured,
                                                                    FieldProbe& probe, const ProxyBox& box,
                                                                    const March& march) {
  constexpr double darkest = 1e-3;
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  SlopeProbe slopes(measured, probe, march);
  std::vector<LitRay> seen;
  for (LitRay& ray : long_rays(rays, march.steps)) {
    LitRay with = slopes.with_values(std::move(ray));
    if (!with.values.empty()) seen.push_back(std::move(with));
  }
  if (seen.empty()) return Refusal{"no value is translucent on a long ray: light cannot be measured"};
  const LitRay& ray = seen.front();
  if (!(brightest(tints_of(ray.even)) > darkest))
    return Refusal{"even fields are black under the light: their colours cannot be told"};
  const auto spaces = light_spaces(measured, march);
  const auto space = std::ranges::find_if(spaces, [&](const auto& s) { return is_round(slopes, ray, s); });
  if (space == spaces.end()) return Refusal{"the light does not shine from the eye"};
  if (!is_the_same_for_any_steepness(slopes, ray, LightSpace(*space, ray.way.way)))
    return Refusal{"colour or opacity depend on how steep a gradient is"};
  auto measured_light = light_on(slopes, ray, *space);
  if (auto* const refusal = std::get_if<Refusal>(&measured_light)) return std::move(*refusal);
  auto& light = std::get<volume::Light>(measured_light);
  const auto reach = gradient_reach(slopes, ray, light, measured.texture.size);
  if (!reach) return Refusal{"gradients look farther than eight texels"};
  light.reach = *reach;
  constexpr std::array<double, 4> looked_at{0.2, 0.9, 1.5, 2.6};
  for (const LitRay& other : std::span(seen).subspan(1)) {
    if (!shows_light(slopes, other, light, looked_at, slope_texels))
      return Refusal{"the light does not shine along every ray"};
  }
  auto lights =
      as_seen(light, lit_values(slopes, ray, axis_of_entry(box.region, ray.way), light, measured.range));
  if (lights.empty()) return another_colour;
  return lights;
}

bool still_lit(const MarchContext& measured, FieldProbe& probe, const ProxyBox& box, const March& march) {
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  const auto middle = rays.middle();
  const auto way = rays.through(middle[0], middle[1]);
  if (!way) return true;
  const auto value = half_seen_value(march, way->way);
  if (!value) return false;
  SlopeProbe slopes(measured, probe, march);
  LitRay ray{middle[0], middle[1], *way, {*value}};
  ray.even = slopes.even(ray.x, ray.y, ray.values);
  constexpr std::array looked_at{0.3, 1.2};
  return is_translucent(ray.even.front()) && shows_light(slopes, ray, *march.light, looked_at, coarse_texels);
}

}  // namespace understudy::spu
