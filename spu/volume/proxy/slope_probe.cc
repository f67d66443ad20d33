// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/slope_probe.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <utility>

#include "spu/volume/classification/table_lookup.h"
#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/ray_probes.h"
#include "spu/volume/proxy/step_fit.h"
#include "volume/matrix.h"

namespace understudy::spu {

using volume::Rgba;
using volume::Vec3;

namespace {

/// How far a field rises along its steepest axis, as a fraction of the range of values. Neighbours that are a
/// texel apart then differ by hundreds of a float's last bits, and the values on the ray by a few entries of
/// the table.
constexpr float least_share = 0.003F;

/// Multiples of the least rise that are tried.
constexpr std::array<double, 2> steepnesses{16, 4};

/// So steep that no guard against a division by zero matters: in a volume of hundreds of texels along an axis,
/// neighbouring texels differ by tenths of the range of values.
constexpr double steepest_under_plain_tables = 16384;

constexpr float least_seen = 0.08F;
constexpr float most_seen = 0.92F;

std::optional<LitRay> ray_at(const RaysThroughBox& rays, double x, double y) {
  const auto way = rays.through(x, y);
  if (!way) return std::nullopt;
  return LitRay{x, y, *way, {}, {}};
}

/// Returns the gradient, of largest component 1, over which the values on a ray differ most.
Vec3 rising_most(const Vec3& way) {
  return {std::copysign(1.0, way[0]), std::copysign(1.0, way[1]), std::copysign(1.0, way[2])};
}

/// Returns the mean place of a ray's samples, each weighted by what is visible of it.
double mean_place_seen(std::span<const double> places, std::span<const double> opacities) {
  double through = 1;
  double sum = 0;
  double moment = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double seen = through * opacities[i];
    through -= seen;
    sum += seen;
    moment += seen * places[i];
  }
  return sum > 0 ? moment / sum : 0;
}

}  // namespace

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

std::vector<Tint> tints_of(const std::vector<Rgba>& colours) {
  std::vector<Tint> tints;
  tints.reserve(colours.size());
  for (const Rgba& colour : colours) tints.push_back(tint_of(colour));
  return tints;
}

bool is_translucent(const Rgba& colour) {
  return reached(colour) && colour[3] > least_seen && colour[3] < most_seen;
}

SlopeProbe::SlopeProbe(const MarchContext& measured, FieldProbe& probe, const March& march)
    : probe_(probe),
      march_(march),
      premultiplied_(premultiplied_already(measured, march)),
      range_(measured.range),
      size_(measured.texture.size),
      neighbours_(measured.neighbours) {}

float SlopeProbe::least_rise() const {
  return least_share * (range_[1] - range_[0]);
}

/// Gradients that count texels use the field's texels, so the field has the volume's proportions, as far as
/// possible.
std::array<int, 3> SlopeProbe::field_size(int texels) const {
  constexpr double fewest = 4;
  if (!counts_texels()) return {texels, texels, texels};
  const int longest = *std::ranges::max_element(size_);
  std::array<int, 3> size{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    size[axis] = int(std::lround(std::max(fewest, double(texels) * size_[axis] / longest)));
  return size;
}

std::vector<Rgba> SlopeProbe::premultiplied_all(std::vector<Rgba> fragments) const {
  for (Rgba& fragment : fragments) {
    if (reached(fragment)) fragment = premultiplied(fragment, premultiplied_);
  }
  return fragments;
}

std::vector<Rgba> SlopeProbe::even(double x, double y, const std::vector<float>& values) {
  return premultiplied_all(probe_.at(x, y, values));
}

std::vector<Rgba> SlopeProbe::base(double x, double y, const std::vector<float>& values) {
  std::vector<Rgba> colours = even(x, y, values);
  if (!is_black_where_even(march_)) return colours;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Rgba sample = table_at(march_.table, values[i]);
    for (std::size_t c = 0; c < 3 && reached(colours[i]) && sample[3] > 0; ++c)
      colours[i][c] = sample[c] / sample[3] * colours[i][3];
  }
  return colours;
}

std::vector<Rgba> SlopeProbe::over(const LitRay& ray, const std::vector<float>& values,
                                   std::span<const Vec3> gradients,
                                   const std::function<double(float, const Vec3&)>& steepness_for, int texels) {
  const std::array<int, 3> size = field_size(texels);
  std::vector<FieldProbe::SlopedField> fields;
  fields.reserve(gradients.size() * values.size());
  for (const Vec3& gradient : gradients) {
    const Vec3 slope = risen(gradient, 1, size);
    const double rise_of_way = volume::dot(slope, ray.way.way);
    for (std::size_t v = 0; v < values.size(); ++v) {
      const double steepness = steepness_for(values[v], gradient);
      const double at_entry = samples_over_rise(ray, values[v], steepness * rise_of_way).value_at_entry;
      fields.push_back({float(at_entry), float(steepness), {slope, ray.way.entry, size}});
      if (!ray.tables.empty()) fields.back().tables = ray.tables[v];
    }
  }
  return premultiplied_all(probe_.at_slopes(ray.x, ray.y, fields));
}

SlopeProbe::SamplesOverRise SlopeProbe::samples_over_rise(const LitRay& ray, float value,
                                                          double rise_of_way) const {
  constexpr int corrections = 3;  // what is visible depends on the values, and the values on what is visible
  const std::vector<double> places = places_on_way(march_.steps, ray.way.way);
  SamplesOverRise samples{double(value), std::vector<double>(places.size(), sample_opacity(ray, value))};
  for (int i = 0; i < corrections; ++i) {
    samples.value_at_entry = double(value) - rise_of_way * mean_place_seen(places, samples.opacities);
    for (std::size_t k = 0; k < places.size(); ++k)
      samples.opacities[k] = sample_opacity(ray, float(samples.value_at_entry + rise_of_way * places[k]));
  }
  return samples;
}

std::vector<double> SlopeProbe::opacities_over(const LitRay& ray, float value, const Vec3& gradient,
                                               double steepness, int texels) const {
  const double rise_of_way = volume::dot(risen(gradient, 1, field_size(texels)), ray.way.way);
  return samples_over_rise(ray, value, steepness * rise_of_way).opacities;
}

double SlopeProbe::allowed_steepness(const LitRay& ray, float value, const Vec3& gradient) const {
  if (!ray.tables.empty()) return steepest_under_plain_tables;
  // Where colours change linearly around the value, samples in front of it and behind it compensate each other,
  // but for what opacity hides.
  constexpr double bent = 0.015;      // of the brightest channel
  constexpr double same_tint = 0.15;  // likewise
  constexpr float same_opacity = 0.15F;
  const float entry = (range_[1] - range_[0]) / float(march_.table.entries.size());
  const Rgba at_value = table_at(march_.table, value);
  const Tint tint = tint_of(at_value);
  const double bright = brightest({tint});
  const auto is_even = [&](float away) {
    const std::array around{table_at(march_.table, value - away), table_at(march_.table, value + away)};
    if (value - away < range_[0] || value + away > range_[1]) return false;
    for (const Rgba& colour : around) {
      if (std::abs(colour[3] - at_value[3]) > same_opacity * at_value[3] ||
          difference(tint_of(colour), tint) > same_tint * bright)
        return false;
    }
    const Tint before = tint_of(around[0]);
    const Tint behind = tint_of(around[1]);
    return difference(tint, {(before[0] + behind[0]) / 2, (before[1] + behind[1]) / 2,
                             (before[2] + behind[2]) / 2}) <= bent * bright;
  };
  for (const double steepness : steepnesses) {
    if (steepness > march_.slope_steepness) continue;
    const float rise = rise_along(ray, gradient, steepness);
    const int entries = 1 + int(rise / entry);
    bool even = true;
    for (int i = 1; i <= entries && even; ++i) even = is_even(rise * float(i) / float(entries));
    if (even) return steepness;
  }
  return 1;
}

Vec3 SlopeProbe::risen(const Vec3& gradient, double steepness, const std::array<int, 3>& size) const {
  Vec3 risen = volume::scale(gradient, steepness * double(least_rise()));
  if (!counts_texels()) return risen;
  // From texel to texel, the field rises as it would in the volume.
  const double longest = double(*std::ranges::max_element(size)) / *std::ranges::max_element(size_);
  for (std::size_t axis = 0; axis < 3; ++axis) risen[axis] *= size[axis] / (longest * size_[axis]);
  return risen;
}

EvenRise SlopeProbe::rise(const Vec3& gradient, double steepness, const std::array<double, 3>& reach,
                          int texels) const {
  EvenRise field{volume::scale(gradient, steepness * double(least_rise())), field_size(texels), {}};
  // Gradients that count texels see the rise from texel to texel, as in a volume of that many texels.
  if (counts_texels())
    field.gradient = volume::scale(
        field.gradient, double(*std::ranges::max_element(size_)) / *std::ranges::max_element(field.texels));
  for (std::size_t axis = 0; axis < 3; ++axis)
    field.reach[axis] = reach[axis] / (counts_texels() ? field.texels[axis] : size_[axis]);
  return field;
}

double SlopeProbe::sample_opacity(const LitRay& ray, float value) const {
  return ray.tables.empty() ? sample_opacity(value) : ray.plain_opacity;
}

double SlopeProbe::sample_opacity(float value) const {
  return double(table_at(march_.table, value)[3]);
}

double SlopeProbe::part_of_volume(std::size_t axis, double texels) const {
  return texels / size_[axis];
}

double SlopeProbe::reach_in_stripes(std::size_t axis, double part) const {
  return part * (counts_texels() ? FieldProbe::field_texels : size_[axis]);
}

double SlopeProbe::part_of_stripes(std::size_t axis, double texels) const {
  return texels / (counts_texels() ? FieldProbe::field_texels : size_[axis]);
}

double SlopeProbe::allowed_steepness(const LitRay& ray) const {
  double least = march_.slope_steepness;
  for (const float value : ray.values)
    least = std::min(least, allowed_steepness(ray, value, rising_most(ray.way.way)));
  return least;
}

float SlopeProbe::rise_along(const LitRay& ray, const Vec3& gradient, double steepness) const {
  // The pixel that is drawn lies beside the ray by a fraction of a pixel.
  constexpr double beside_ray = 1.0 / 512;
  const std::array<int, 3> size = field_size(slope_texels);
  const Vec3 slope = risen(gradient, steepness, size);
  double rise = std::abs(volume::dot(slope, ray.way.way)) / 2 + beside_ray * volume::length(slope);
  // Within half a texel of the texture's ends, a field is constant.
  const Vec3 exit = volume::add(ray.way.entry, ray.way.way);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double place : {ray.way.entry[axis], exit[axis]})
      rise += std::abs(slope[axis]) * std::max(0.0, 0.5 / size[axis] - std::min(place, 1 - place));
  }
  return float(rise);
}

double SlopeProbe::stripes_differ(const LitRay& ray) const {
  const double gentlest = 0.5 * double(least_rise());
  return ray.tables.empty() ? gentlest : steepest_under_plain_tables * gentlest;
}

Tint SlopeProbe::over_stripes(const LitRay& ray, std::size_t axis, int width) {
  constexpr int shifts = 16;
  const auto half = float(stripes_differ(ray) / 2);
  std::vector<FieldProbe::StripedField> fields;
  fields.reserve(shifts);
  for (int i = 0; i < shifts; ++i)
    fields.push_back(
        {axis, width, 2 * width * i / shifts, {ray.values.front() - half, ray.values.front() + half}});
  if (!ray.tables.empty()) {
    for (FieldProbe::StripedField& field : fields) field.tables = ray.tables.front();
  }
  Tint mean{};
  for (const Rgba& colour : premultiplied_all(probe_.at_stripes(ray.x, ray.y, fields))) {
    const Tint tint = tint_of(colour);
    for (std::size_t c = 0; c < 3; ++c) mean[c] += tint[c] / shifts;
  }
  return mean;
}

LitRay SlopeProbe::with_values(LitRay ray) {
  constexpr std::size_t most = 3;
  constexpr double same = 0.02;
  const std::vector<float> values = values_over(range_);
  const float beside = 0.5F * least_rise();
  std::vector<float> all;
  for (const float value : values) all.insert(all.end(), {value - beside, value, value + beside});
  const std::vector<Rgba> shown = base(ray.x, ray.y, all);
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::array around{shown[3 * i], shown[3 * i + 1], shown[3 * i + 2]};
    if (values[i] - beside < range_[0] || values[i] + beside > range_[1]) continue;
    if (!std::ranges::all_of(around, is_translucent)) continue;
    const Tint tint = tint_of(around[1]);
    if (difference(tint, tint_of(around[0])) > same || difference(tint, tint_of(around[2])) > same) continue;
    candidates.push_back(i);
  }
  // Light makes colours several times as bright, and programs clamp them.
  constexpr double bright = 0.25;
  constexpr double dark = 0.02;
  const auto brightness = [&](std::size_t i) { return difference(tint_of(shown[3 * i + 1]), {}); };
  const auto is_moderate = [&](std::size_t i) { return brightness(i) > dark && brightness(i) < bright; };
  if (std::ranges::any_of(candidates, is_moderate))
    std::erase_if(candidates, [&](std::size_t i) { return !is_moderate(i); });
  const Vec3 steepest = rising_most(ray.way.way);
  // If opacity has a step near the value, a slope shows another opacity than a constant field.
  const float farthest = 1.5F * rise_along(ray, steepest, 1);
  const auto keeps_opacity = [&](std::size_t i) {
    constexpr double same_opacity = 0.3;
    const double here = sample_opacity(values[i]);
    return std::abs(sample_opacity(values[i] - farthest) - here) <= same_opacity * here &&
           std::abs(sample_opacity(values[i] + farthest) - here) <= same_opacity * here;
  };
  if (std::ranges::any_of(candidates, keeps_opacity))
    std::erase_if(candidates, [&](std::size_t i) { return !keeps_opacity(i); });
  const auto spread = [&](const std::vector<std::size_t>& some) {
    double most_apart = 0;
    for (const std::size_t i : some) {
      for (const std::size_t j : some)
        most_apart = std::max(most_apart, difference(tint_of(shown[3 * i + 1]), tint_of(shown[3 * j + 1])));
    }
    return most_apart;
  };
  for (const double steepness : steepnesses) {
    constexpr double enough = 0.5;
    std::vector<std::size_t> steep;
    std::ranges::copy_if(candidates, std::back_inserter(steep), [&](std::size_t i) {
      return allowed_steepness(ray, values[i], steepest) >= steepness;
    });
    if (steep.size() < most || spread(steep) < enough * spread(candidates)) continue;
    candidates = std::move(steep);
    break;
  }
  while (!candidates.empty() && ray.values.size() < most) {
    const std::vector<Tint> chosen = tints_of(ray.base);
    // First the brightest value, then the one that differs most from all that were chosen.
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
    ray.base.push_back(shown[3 * best + 1]);
  }
  return ray;
}

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

std::vector<LitRay> brief_rays(const RaysThroughBox& rays, const volume::RaySteps& steps) {
  const auto middle = rays.middle();
  const auto through_middle = rays.way(middle[0], middle[1]);
  std::vector<LitRay> found;
  if (!through_middle) return found;
  const double longest = steps_of_way(steps, *through_middle);
  for (const double part : {0.25, 0.125}) {
    const Ray brief = ray_of_length(rays, steps, part * longest);
    if (const auto ray = ray_at(rays, brief.x, brief.y)) found.push_back(*ray);
  }
  return found;
}

std::vector<LitRay> near_and_far_rays(const RaysThroughBox& rays, const volume::RaySteps& steps,
                                      const volume::Matrix4& texture_to_clip) {
  constexpr double part = 0.25;
  const auto middle = rays.middle();
  const auto through_middle = rays.way(middle[0], middle[1]);
  if (!through_middle) return {};
  const double wanted = part * steps_of_way(steps, *through_middle);
  const auto depth = [&](const LitRay& ray) {
    const volume::Vec3 halfway = volume::add(ray.way.entry, volume::scale(ray.way.way, 0.5));
    return volume::transform_point(texture_to_clip, halfway)[3];
  };
  std::vector<LitRay> found;
  for (const Ray& ray : rays_of_length(rays, steps, wanted)) {
    if (std::abs(ray.length - wanted) > 0.2 * wanted) continue;
    if (auto seen = ray_at(rays, ray.x, ray.y)) found.push_back(*std::move(seen));
  }
  if (found.size() < 2) return found;
  const auto [nearest, farthest] = std::ranges::minmax_element(found, {}, depth);
  return {*nearest, *farthest};
}

}  // namespace understudy::spu
