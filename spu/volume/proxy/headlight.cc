// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/headlight.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/ray_probes.h"
#include "volume/matrix.h"

namespace understudy::spu {

using volume::Rgba;
using volume::Vec3;

namespace {

/// By so much of the range of values does a field rise along its steepest axis. Neighbours that are a texel
/// apart then differ by thousands of a float's last bits, and the values on the ray by a few entries of the
/// table.
constexpr float rise = 0.003F;
/// Texels along each axis of a field: at both ends half a texel is even.
constexpr int field_texels = 32;
constexpr int coarse_field_texels = 16;
constexpr int fine_field_texels = 2048;  ///< of fields that rise along one axis
constexpr int angles = 65;               ///< between normal and ray, from 0 to pi
constexpr int responses = 1025;          ///< of volume::Light
constexpr double golden = 2.39996;       ///< radians: turns by it come close to no earlier one for long

/// Opacities of rays whose colours tell.
constexpr float least_seen = 0.08F;
constexpr float most_seen = 0.92F;

const Refusal another_colour{"the light has a colour, or shows slopes in another one than even fields"};

/// Colour over opacity, by channel.
using Tint = std::array<double, 3>;

Tint tint_of(const Rgba& premultiplied) {
  const double alpha = double(premultiplied[3]);
  return {double(premultiplied[0]) / alpha, double(premultiplied[1]) / alpha, double(premultiplied[2]) / alpha};
}

double difference(const Tint& a, const Tint& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

double brightest(const std::vector<Tint>& tints) {
  double most = 0;
  for (const Tint& tint : tints) most = std::max({most, tint[0], tint[1], tint[2]});
  return most;
}

/// A ray, and values whose fields are translucent on it.
struct LitRay {
  double x = 0;
  double y = 0;
  WayThroughBox way;
  std::vector<float> values;
  std::vector<Rgba> even;  ///< premultiplied: what fields of one value show

  std::vector<Tint> even_tints() const {
    std::vector<Tint> tints;
    for (const Rgba& colour : even) tints.push_back(tint_of(colour));
    return tints;
  }
};

/// The space in which angles are measured, and in it the directions from a ray to the eye and across.
class LightSpace {
 public:
  LightSpace(const std::array<double, 9>& space, const Vec3& way) : space_(space) {
    Vec3 back{};
    for (std::size_t row = 0; row < 3; ++row) back[row] = -dot(row_of(row), way);
    to_eye_ = unit(back);
    const std::size_t least = std::size_t(
        std::ranges::min_element(to_eye_, {}, [](double v) { return std::abs(v); }) - to_eye_.begin());
    Vec3 axis{};
    axis[least] = 1;
    right_ = unit(volume::cross(to_eye_, axis));
    up_ = volume::cross(to_eye_, right_);
  }

  /// Of a field in texture space that falls fastest at `angle` to the eye, turned about the ray; its largest
  /// component is 1.
  Vec3 gradient(double angle, double turn) const {
    Vec3 normal{};
    for (std::size_t i = 0; i < 3; ++i)
      normal[i] = std::cos(angle) * to_eye_[i] +
                  std::sin(angle) * (std::cos(turn) * right_[i] + std::sin(turn) * up_[i]);
    Vec3 gradient{};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t i = 0; i < 3; ++i) gradient[k] -= space_[3 * i + k] * normal[i];
    const double largest = std::max({std::abs(gradient[0]), std::abs(gradient[1]), std::abs(gradient[2])});
    return volume::scale(gradient, 1 / largest);
  }

 private:
  Vec3 row_of(std::size_t row) const { return {space_[3 * row], space_[3 * row + 1], space_[3 * row + 2]}; }
  static double dot(const Vec3& a, const Vec3& b) { return volume::dot(a, b); }
  static Vec3 unit(const Vec3& v) { return volume::scale(v, 1 / volume::length(v)); }

  std::array<double, 9> space_;
  Vec3 to_eye_{}, right_{}, up_{};
};

/// The cosine between the direction to the eye and the normal of planes across a texture axis, behind which the
/// field is larger.
double cosine_of_planes(const std::array<double, 9>& space, const Vec3& way, std::size_t axis) {
  const Vec3 a{space[0], space[1], space[2]};
  const Vec3 b{space[3], space[4], space[5]};
  const Vec3 c{space[6], space[7], space[8]};
  const Vec3 forwards{volume::dot(a, way), volume::dot(b, way), volume::dot(c, way)};
  // The inverse's transpose, which takes gradients to this space.
  const double determinant = volume::dot(a, volume::cross(b, c));
  const Vec3 normal{volume::cross(b, c)[axis] / determinant, volume::cross(c, a)[axis] / determinant,
                    volume::cross(a, b)[axis] / determinant};
  return volume::dot(normal, forwards) / (volume::length(normal) * volume::length(forwards));
}

/// Looks at rays over slopes.
class SlopeProbe {
 public:
  SlopeProbe(const MarchContext& measured, FieldProbe& probe, const March& march)
      : probe_(probe),
        premultiplied_(premultiplied_already(measured, march)),
        range_(measured.range[1] - measured.range[0]) {}

  std::vector<Rgba> even(double x, double y, const std::vector<float>& values) {
    return finished(probe_.at(x, y, values));
  }

  /// Colours of the ray's values over fields of this slope, which is a multiple of `rise`.
  std::vector<Rgba> over(const LitRay& ray, const Vec3& gradient, double steepness = 1,
                         int texels = field_texels) {
    return over(ray, ray.values, gradient, steepness, texels);
  }
  std::vector<Rgba> over(const LitRay& ray, const std::vector<float>& values, const Vec3& gradient,
                         double steepness = 1, int texels = field_texels) {
    const Vec3 middle = volume::add(ray.way.entry, volume::scale(ray.way.way, 0.5));
    return finished(probe_.at_gradient(
        ray.x, ray.y, values, {volume::scale(gradient, steepness * double(rise * range_)), middle, texels}));
  }

  /// By how much at most the values on a ray differ from that in its middle, over a slope so steep along it.
  float rise_along(double steepness) const {
    constexpr double part = 0.75;  // a ray is longer than an edge of the box, but seldom goes through both ends
    return float(part * std::abs(steepness)) * rise * range_;
  }

  /// The colour of the ray's first value, on average over stripes of a width across `axis` that begin anywhere.
  Tint over_stripes(const LitRay& ray, std::size_t axis, int width) {
    constexpr int shifts = 16;
    const float half = 0.25F * rise * range_;
    std::vector<FieldProbe::StripedField> fields;
    fields.reserve(shifts);
    for (int i = 0; i < shifts; ++i)
      fields.push_back(
          {axis, width, 2 * width * i / shifts, {ray.values.front() - half, ray.values.front() + half}});
    Tint mean{};
    for (const Rgba& colour : finished(probe_.at_stripes(ray.x, ray.y, fields))) {
      const Tint tint = tint_of(colour);
      for (std::size_t c = 0; c < 3; ++c) mean[c] += tint[c] / shifts;
    }
    return mean;
  }

 private:
  std::vector<Rgba> finished(std::vector<Rgba> fragments) const {
    for (Rgba& fragment : fragments) {
      if (reached(fragment)) fragment = premultiplied(fragment, premultiplied_);
    }
    return fragments;
  }

  FieldProbe& probe_;
  bool premultiplied_;
  float range_;
};

std::vector<Tint> tints_of(const std::vector<Rgba>& colours) {
  std::vector<Tint> tints;
  tints.reserve(colours.size());
  for (const Rgba& colour : colours) tints.push_back(tint_of(colour));
  return tints;
}

bool is_seen(const Rgba& colour) {
  return reached(colour) && colour[3] > least_seen && colour[3] < most_seen;
}

/// Up to three of `values` that the ray shows translucent, at no step of the table, and in colours that differ
/// as much as they can.
LitRay with_values(LitRay ray, SlopeProbe& slopes, const std::array<float, 2>& range) {
  constexpr std::size_t most = 3;
  constexpr double same = 0.02;
  const std::vector<float> values = values_over(range);
  const float beside = 0.5F * rise * (range[1] - range[0]);
  std::vector<float> all;
  for (const float value : values) all.insert(all.end(), {value - beside, value, value + beside});
  const std::vector<Rgba> shown = slopes.even(ray.x, ray.y, all);
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::array around{shown[3 * i], shown[3 * i + 1], shown[3 * i + 2]};
    if (values[i] - beside < range[0] || values[i] + beside > range[1]) continue;
    if (!std::ranges::all_of(around, is_seen)) continue;
    const Tint tint = tint_of(around[1]);
    if (difference(tint, tint_of(around[0])) > same || difference(tint, tint_of(around[2])) > same) continue;
    candidates.push_back(i);
  }
  // Light makes colours several times as bright as they are in even fields, and programs clamp them.
  constexpr double bright = 0.25;
  constexpr double dark = 0.02;
  const auto brightness = [&](std::size_t i) { return difference(tint_of(shown[3 * i + 1]), {}); };
  const auto is_moderate = [&](std::size_t i) { return brightness(i) > dark && brightness(i) < bright; };
  if (std::ranges::any_of(candidates, is_moderate))
    std::erase_if(candidates, [&](std::size_t i) { return !is_moderate(i); });
  while (!candidates.empty() && ray.values.size() < most) {
    const std::vector<Tint> chosen = ray.even_tints();
    // The first is the brightest; then the one that is farthest from all others.
    const auto distance = [&](std::size_t i) {
      const Tint tint = tint_of(shown[3 * i + 1]);
      if (chosen.empty()) return brightness(i);
      double least = difference(tint, chosen.front());
      for (const Tint& other : chosen) least = std::min(least, difference(tint, other));
      return least;
    };
    const std::size_t best = *std::ranges::max_element(candidates, {}, distance);
    if (!chosen.empty() && distance(best) < 1e-3) break;
    ray.values.push_back(values[best]);
    ray.even.push_back(shown[3 * best + 1]);
  }
  return ray;
}

std::optional<LitRay> ray_at(const RaysThroughBox& rays, double x, double y) {
  const auto way = rays.through(x, y);
  if (!way) return std::nullopt;
  return LitRay{x, y, *way, {}, {}};
}

/// Rays that go far through the box: the longest, and others a little away from the middle of the view.
std::vector<LitRay> long_rays(const RaysThroughBox& rays, const volume::RaySteps& steps) {
  const auto middle = rays.middle();
  std::vector<LitRay> found;
  if (const auto ray = ray_at(rays, middle[0], middle[1])) found.push_back(*ray);
  if (found.empty()) return found;
  const double longest = steps_of_way(steps, found.front().way.way);
  for (const double part : {0.75, 0.5}) {
    const Ray other = ray_of_length(rays, steps, part * longest);
    if (const auto ray = ray_at(rays, other.x, other.y)) found.push_back(*ray);
  }
  return found;
}

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

volume::LightResponse response_at(const volume::Light& light, double angle) {
  const double place = (std::cos(angle) + 1) / 2 * double(light.response.size() - 1);
  return light.response[std::size_t(std::lround(place))];
}

/// Whether `ray`, whose even colours are known, shows the light at these angles.
bool shows_light(SlopeProbe& slopes, const LitRay& ray, const volume::Light& light,
                 std::span<const double> looked_at, int texels) {
  constexpr double same = 0.05;
  const LightSpace directions(light.space, ray.way.way);
  const std::vector<Tint> even = ray.even_tints();
  for (const double angle : looked_at) {
    const std::vector<Rgba> shown = slopes.over(ray, directions.gradient(angle, 1 + 3 * angle), 1, texels);
    if (!std::ranges::all_of(shown, reached)) return false;
    const std::vector<Tint> lit = tints_of(shown);
    const volume::LightResponse response = response_at(light, angle);
    for (std::size_t v = 0; v < lit.size(); ++v) {
      Tint expected;
      for (std::size_t c = 0; c < 3; ++c)
        expected[c] = double(response.diffuse) * even[v][c] + double(response.specular);
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
  const std::vector<float> values = values_over(range, count);
  const std::vector<Rgba> even = slopes.even(ray.x, ray.y, values);
  const double cosine = cosine_of_planes(light.space, ray.way.way, axis);
  std::vector<LitValue> lit;
  for (const double side : {1.0, -1.0}) {
    Vec3 gradient{};
    gradient[axis] = side;
    const std::vector<Rgba> shown = slopes.over(ray, values, gradient, 1, fine_field_texels);
    const volume::LightResponse response = response_at(light, std::acos(std::clamp(side * cosine, -1.0, 1.0)));
    for (std::size_t i = 1; i + 1 < values.size(); ++i) {
      const auto is_visible = [](const Rgba& colour) { return reached(colour) && colour[3] > least_seen; };
      if (!is_visible(even[i - 1]) || !is_visible(even[i]) || !is_visible(even[i + 1]) || !is_visible(shown[i]))
        continue;
      const Tint tint = tint_of(even[i]);
      if (difference(tint, tint_of(even[i - 1])) > step || difference(tint, tint_of(even[i + 1])) > step)
        continue;
      LitValue value{tint_of(shown[i]), {}};
      for (std::size_t c = 0; c < 3; ++c)
        value.expected[c] = double(response.diffuse) * tint[c] + double(response.specular);
      lit.push_back(value);
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

/// How many texels away gradients look along an axis, where the ray shows it: between stripes of nearly one
/// value, samples are lit that have another stripe within their reach.
std::optional<double> reach_along(SlopeProbe& slopes, const LitRay& ray, const volume::Light& light,
                                  std::size_t axis, int size) {
  constexpr double tells = 0.05;
  const double cosine = cosine_of_planes(light.space, ray.way.way, axis);
  const Tint even = ray.even_tints().front();
  Tint lit{};
  for (const double side : {cosine, -cosine}) {
    const volume::LightResponse response = response_at(light, std::acos(std::clamp(side, -1.0, 1.0)));
    for (std::size_t c = 0; c < 3; ++c)
      lit[c] += (double(response.diffuse) * even[c] + double(response.specular)) / 2;
  }
  std::size_t channel = 0;
  for (std::size_t c = 1; c < 3; ++c) {
    if (std::abs(lit[c] - even[c]) > std::abs(lit[channel] - even[channel])) channel = c;
  }
  const double contrast = lit[channel] - even[channel];
  if (std::abs(contrast) < tells) return std::nullopt;
  // Narrow stripes tell a short reach better, and no long one.
  std::optional<double> reach;
  for (const int width : {64, 16}) {
    const double part = (slopes.over_stripes(ray, axis, width)[channel] - even[channel]) / contrast;
    constexpr double most_part = 0.5;
    if (!reach || part < most_part) reach = part * width * FieldProbe::split_unit / 2 * size;
  }
  return reach;
}

/// Along all axes; those that the ray does not show look as far as the others.
std::optional<std::array<double, 3>> reach_of(SlopeProbe& slopes, const LitRay& ray, const volume::Light& light,
                                              const std::array<int, 3>& size) {
  constexpr double least = 0.2;
  constexpr double most = 8;
  std::array<std::optional<double>, 3> seen;
  std::vector<double> known;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    seen[axis] = reach_along(slopes, ray, light, axis, size[axis]);
    if (!seen[axis]) continue;
    // Whole texels, but for what counting samples leaves open.
    const double whole = std::round(*seen[axis]);
    if (whole >= 1 && std::abs(*seen[axis] - whole) < 0.1) seen[axis] = whole;
    known.push_back(*seen[axis]);
  }
  std::array<double, 3> reach{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    reach[axis] = seen[axis].value_or(known.empty() ? 1 : *std::ranges::max_element(known));
    if (!(reach[axis] >= least && reach[axis] <= most)) return std::nullopt;
  }
  return reach;
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
  const std::vector<Tint> even = ray.even_tints();
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
    LitRay with = with_values(std::move(ray), slopes, measured.range);
    if (!with.values.empty()) seen.push_back(std::move(with));
  }
  if (seen.empty()) return Refusal{"no value is translucent on a long ray: light cannot be measured"};
  const LitRay& ray = seen.front();
  if (!(brightest(ray.even_tints()) > darkest))
    return Refusal{"even fields are black under the light: their colours cannot be told"};
  const auto spaces = light_spaces(measured, march);
  const auto space = std::ranges::find_if(spaces, [&](const auto& s) { return is_round(slopes, ray, s); });
  if (space == spaces.end()) return Refusal{"the light does not shine from the eye"};
  if (!is_the_same_for_any_steepness(slopes, ray, LightSpace(*space, ray.way.way)))
    return Refusal{"colour or opacity depend on how steep a gradient is"};
  auto measured_light = light_on(slopes, ray, *space);
  if (auto* const refusal = std::get_if<Refusal>(&measured_light)) return std::move(*refusal);
  auto& light = std::get<volume::Light>(measured_light);
  const auto reach = reach_of(slopes, ray, light, measured.texture.size);
  if (!reach) return Refusal{"gradients look farther than eight texels"};
  light.reach = *reach;
  constexpr std::array<double, 4> looked_at{0.2, 0.9, 1.5, 2.6};
  for (const LitRay& other : std::span(seen).subspan(1)) {
    if (!shows_light(slopes, other, light, looked_at, field_texels))
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
  auto ray = ray_at(rays, middle[0], middle[1]);
  if (!ray) return true;
  SlopeProbe slopes(measured, probe, march);
  ray->values = {march.translucent};
  ray->even = slopes.even(ray->x, ray->y, ray->values);
  if (!is_seen(ray->even.front())) return true;
  constexpr std::array looked_at{0.3, 1.2};
  return shows_light(slopes, *ray, *march.light, looked_at, coarse_field_texels);
}

}  // namespace understudy::spu
