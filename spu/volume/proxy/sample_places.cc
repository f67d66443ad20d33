// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/sample_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "spu/volume/classification/table_lookup.h"
#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/step_fit.h"
#include "volume/matrix.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

/// The quantity that adds up sample by sample: optical depth, or one channel of a sum.
struct Additive {
  bool sum = false;
  std::size_t channel = 3;
  float most_told = 0.99F;  ///< beyond it, programs have terminated the ray

  std::optional<double> of(const Rgba& ray) const {
    if (!reached(ray) || !(ray[channel] >= 0 && ray[channel] <= most_told)) return std::nullopt;
    return sum ? double(ray[channel]) : -std::log1p(-double(ray[channel]));
  }
};

/// The value whose samples add up least like those of the translucent one, and the quantity that shows it.
struct Contrast {
  float value = 0;
  Additive amount;
};

BackgroundContrast contrast_by(const ShaderBackground& background, const Rgba& ray) {
  if (!(ray[3] > 0)) return {};
  return {volume::subtract(volume::scale(colour_of(ray), 1 / double(ray[3])), background.colour), 0};
}

/// Whether colours determine the opacity of a ray that has samples of both.
bool told_apart(const ShaderBackground& background, const Rgba& a, const Rgba& b) {
  return opacity_of(contrast_by(background, a), contrast_by(background, b), {}).has_value();
}

std::optional<Contrast> contrast_to(const Rgba& translucent, const March& march,
                                    const std::vector<SeenValue>& values, float most_told) {
  constexpr double least_told = 0.25;  // of the translucent value's amount
  constexpr float below_limit = 1e-4F;
  std::optional<Contrast> best;
  double most = 0;
  for (std::size_t channel = march.sum ? 0 : 3; channel < (march.sum ? 3U : 4U); ++channel) {
    Additive amount{march.sum.has_value(), channel};
    if (!march.sum) amount.most_told = std::min(most_told, march.opacity_limit - below_limit);
    const auto own = amount.of(translucent);
    if (!own) continue;
    for (const SeenValue& seen : values) {
      const auto other = amount.of(seen.ray);
      if (!other || *other > 2 * *own) continue;
      if (march.background && !told_apart(*march.background, translucent, seen.ray)) continue;
      // A value that looks like the background may hide what lies behind it.
      if (march.background && !(seen.ray[3] > 0) && table_at(march.table, seen.value)[3] > 0) continue;
      const double told = std::abs(*other - *own);
      if (told < least_told * *own || told <= most) continue;
      most = told;
      best = Contrast{seen.value, amount};
    }
  }
  return best;
}

/// Likewise on rays so short that the translucent value lets half of the light through: on long ones, all
/// values may be nearly opaque.
std::optional<Contrast> contrast_on_short_rays(const March& march, const std::vector<SeenValue>& values,
                                               float most_told) {
  const auto sample_of = [&](float value) { return table_at(march.table, value); };
  const double opacity = double(sample_of(march.translucent)[3]);
  if (!(opacity > 0 && opacity < 0.5)) return std::nullopt;
  const double samples = std::log(0.5) / std::log1p(-opacity);
  std::vector<SeenValue> shorter;
  shorter.reserve(values.size());
  for (const SeenValue& seen : values)
    shorter.push_back({seen.value, ray_of(march, sample_of(seen.value), samples)});
  return contrast_to(ray_of(march, sample_of(march.translucent), samples), march, shorter, most_told);
}

/// Returns the steps from the ray's first sample to the plane; null if the ray does not cross the plane.
std::optional<double> steps_to_plane(const FieldProbe::SplitField& field, const WayThroughBox& through,
                                     const volume::RaySteps& steps, const SplitRay& ray) {
  const double part = (field.plane - through.entry[field.axis]) / through.way[field.axis];
  if (!(part > 0 && part < 1)) return std::nullopt;
  const double first = steps.first + (steps.offsets ? steps.offsets->at(ray.x, ray.y) : 0);
  return part * (steps.divided ? ray.samples : steps_of_way(steps, through.way)) - first;
}

bool lies_as_said(double front, double samples, double to_plane) {
  constexpr double whole = 0.1;      // how far a count may be from a whole number
  constexpr double rounding = 0.08;  // of a step
  for (const double nudge : {0.0, -rounding, rounding}) {
    const double expected = std::clamp(std::floor(to_plane + nudge) + 1, 0.0, samples);
    if (std::abs(front - expected) <= whole) return true;
  }
  return false;
}

/// Returns how many of `samples` samples have the first of two values, given the amounts along a ray whose
/// samples all have the first, all the second, or some of each.
double samples_of_first(double samples, double all_first, double all_second, double some_of_each) {
  constexpr double nothing = 0.5;  // of a sample of the second value
  constexpr double rounding = 0.1;
  const double one = all_second / samples;
  if (!(all_first > 0 && all_first < nothing * one))
    return samples * (some_of_each - all_second) / (all_first - all_second);
  // So little may be a floor that the program sets for any ray (vispy: 0.001); it may be missing where the
  // second value comes first.
  const double second = some_of_each / one;
  const double whole = std::floor(second + rounding);
  return samples - (second - whole <= all_first / one + rounding ? whole : second);
}

/// Counts samples in front of the planes of fields; needs one field at least.
class SplitCounting {
 public:
  SplitCounting(FieldProbe& probe, const Additive& amount, bool premultiplied_already,
                const std::vector<FieldProbe::SplitField>& fields)
      : probe_(probe), amount_(amount), already_(premultiplied_already) {
    for (const FieldProbe::SplitField& field : fields) all_.push_back({field, {}});
  }

  /// Adds the rays of these pixels of the viewport.
  void add(const volume::Rect& pixels);
  /// Returns the rays with their counts; empty if samples cannot be counted.
  std::vector<SplitRays> counted();

 private:
  /// What adds up along a ray through each of the two values, and through each of the fields.
  struct Amounts {
    double before = 0;
    double behind = 0;
    std::vector<double> split;
  };

  std::optional<double> amount_of(const Rgba& fragment) const {
    return reached(fragment) ? amount_.of(premultiplied(fragment, already_)) : std::nullopt;
  }

  FieldProbe& probe_;
  Additive amount_;
  bool already_;
  std::vector<SplitRays> all_;
  std::vector<Amounts> amounts_;  ///< ray by ray
};

void SplitCounting::add(const volume::Rect& pixels) {
  const auto before = probe_.pixels(pixels, all_.front().field.before);
  const auto behind = probe_.pixels(pixels, all_.front().field.behind);
  std::vector<std::vector<Rgba>> split;
  split.reserve(all_.size());
  for (const SplitRays& rays : all_) split.push_back(probe_.pixels(pixels, rays.field));
  for (std::size_t i = 0; i < behind.size(); ++i) {
    const auto of_first = amount_of(before[i]), of_second = amount_of(behind[i]);
    if (!of_first || !of_second) continue;
    Amounts amounts{*of_first, *of_second, {}};
    for (const auto& fragments : split) {
      if (const auto told = amount_of(fragments[i])) amounts.split.push_back(*told);
    }
    if (amounts.split.size() < all_.size()) continue;
    amounts_.push_back(std::move(amounts));
    const int column = pixels.x + int(i) % pixels.width;
    const int row = pixels.y + int(i) / pixels.width;
    for (SplitRays& rays : all_)
      rays.rays.push_back(
          {{probe_.x_of(column), probe_.y_of(row)}, probe_.left() + column, probe_.bottom() + row});
  }
}

std::vector<SplitRays> SplitCounting::counted() {
  std::vector<double> of_second;
  of_second.reserve(amounts_.size());
  for (const Amounts& amounts : amounts_) of_second.push_back(amounts.behind);
  const std::vector<double> counts = counts_from_amounts(of_second);
  if (counts.empty()) return {};
  for (std::size_t f = 0; f < all_.size(); ++f) {
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const Amounts& amounts = amounts_[i];
      SplitRay& ray = all_[f].rays[i];
      ray.samples = counts[i];
      ray.before = samples_of_first(counts[i], amounts.before, amounts.behind, amounts.split[f]);
    }
  }
  return std::move(all_);
}

std::size_t longest_axis(const volume::Vec3& way) {
  std::size_t longest = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (std::abs(way[k]) > std::abs(way[longest])) longest = k;
  }
  return longest;
}

/// Returns the plane that splits a field at a fraction of the box's extent along an axis; null outside the
/// texture.
std::optional<double> plane_at(const volume::Box& box, std::size_t axis, double part) {
  // A box may extend a texel beyond the texture, and most of a thin one may lie there.
  const double low = std::max(box.low[axis], 0.0);
  const double high = std::min(box.high[axis], 1.0);
  const double place = low + part * (high - low);
  const double plane = std::round(place / FieldProbe::split_unit) * FieldProbe::split_unit;
  if (low < high && plane > 0 && plane < 1) return plane;
  return std::nullopt;
}

/// Adds planes perpendicular to the other axes, if rays like this one cross them steeply enough: a coordinate
/// may be right along one axis and wrong along another.
void add_other_axes(const volume::Box& box, const volume::Vec3& way,
                    std::vector<FieldProbe::SplitField>& fields) {
  constexpr double least_crossed = 0.3;  // of the path's largest component
  const FieldProbe::SplitField first = fields.front();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (axis == first.axis || std::abs(way[axis]) < least_crossed * std::abs(way[first.axis])) continue;
    if (const auto plane = plane_at(box, axis, 0.53))
      fields.push_back({axis, *plane, first.before, first.behind});
  }
}

/// Returns the pixels of the viewport that bound the box, all of which must be in front of the eye.
volume::Rect pixels_of(const FieldProbe& probe, const ProxyBox& box) {
  std::array<double, 2> low{1, 1};
  std::array<double, 2> high{-1, -1};
  for (std::size_t corner = 0; corner < 8; ++corner) {
    volume::Vec3 place = box.region.low;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if ((corner >> axis & 1) != 0) place[axis] = box.region.high[axis];
    }
    const volume::Vec4 clip = volume::transform_point(box.camera.texture_to_clip, place);
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], clip[k] / clip[3]);
      high[k] = std::max(high[k], clip[k] / clip[3]);
    }
  }
  const int left = probe.column_at(low[0]);
  const int bottom = probe.row_at(low[1]);
  return {left, bottom, probe.column_at(high[0]) + 1 - left, probe.row_at(high[1]) + 1 - bottom};
}

std::vector<volume::Rect> pixels_of(const SplitBands& bands, const FieldProbe& probe, const ProxyBox& box,
                                    const std::array<double, 2>& middle) {
  constexpr int rows = 2;
  const int highest_row = std::max(0, probe.height() - rows);
  if (bands.columns_of_middle > 0) {
    const volume::Rect whole = pixels_of(probe, box);
    const int columns = std::min(bands.columns_of_middle, whole.width);
    const int left =
        std::clamp(probe.column_at(middle[0]) - columns / 2, whole.x, whole.x + whole.width - columns);
    const int row = whole.y + int((0.25 + 0.5 * bands.height_of_middle) * whole.height);
    return {{left, std::min(row, highest_row), columns, rows}};
  }
  std::vector<volume::Rect> pixels;
  for (int band = 0; band < bands.number; ++band) {
    const int row = std::clamp((2 * band + 1) * probe.height() / (2 * bands.number), 0, highest_row);
    pixels.push_back({0, row, probe.width(), rows});
  }
  return pixels;
}

}  // namespace

std::vector<SeenValue> seen_values(const std::vector<float>& values, const std::vector<Rgba>& rays) {
  std::vector<SeenValue> seen;
  for (std::size_t i = 0; i < values.size(); ++i) seen.push_back({values[i], rays[i]});
  return seen;
}

std::vector<FieldProbe::SplitField> split_fields(const volume::Box& box, const volume::Vec3& way, float before,
                                                 float behind) {
  const std::size_t axis = longest_axis(way);
  std::vector<FieldProbe::SplitField> fields;
  for (const double part : {0.37, 0.61}) {
    if (const auto plane = plane_at(box, axis, part)) fields.push_back({axis, *plane, before, behind});
  }
  return fields;
}

std::vector<SplitRays> split_rays(const MarchContext& measured, FieldProbe& probe, const March& march,
                                  const ProxyBox& box, const std::vector<SeenValue>& values,
                                  const SplitBands& bands) {
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  const auto middle = rays.middle();
  const auto way = rays.way(middle[0], middle[1]);
  const auto translucent = std::ranges::find(values, march.translucent, &SeenValue::value);
  if (!way || translucent == values.end()) return {};
  // Below the opacity limits that programs usually have.
  constexpr float below_limits = 0.96F;
  constexpr float below_nearly_opaque = 0.99F;
  auto contrast = contrast_to(translucent->ray, march, values, below_limits);
  if (!contrast && !march.sum && !march.background)
    contrast = contrast_on_short_rays(march, values, below_limits);
  if (!contrast) contrast = contrast_to(translucent->ray, march, values, below_nearly_opaque);
  if (!contrast) return {};
  auto fields = split_fields(box.region, *way, contrast->value, march.translucent);
  if (fields.empty()) return {};
  if (bands.across_all_axes) add_other_axes(box.region, *way, fields);
  SplitCounting counting(probe, contrast->amount, premultiplied_already(measured, march), fields);
  for (const volume::Rect& pixels : pixels_of(bands, probe, box, middle)) counting.add(pixels);
  return counting.counted();
}

std::optional<double> misplaced_part(const std::vector<SplitRays>& split, const RaysThroughBox& rays,
                                     const volume::RaySteps& steps) {
  constexpr double fewest_samples = 4;
  constexpr std::size_t fewest_rays = 64;
  std::array<std::size_t, 3> told{};  // by the axis of the plane
  std::array<std::size_t, 3> misplaced{};
  for (const SplitRays& of_field : split) {
    const std::size_t axis = of_field.field.axis;
    for (const SplitRay& ray : of_field.rays) {
      const auto through = rays.through(ray.place[0], ray.place[1]);
      if (!through || ray.samples < fewest_samples) continue;
      const auto to_plane = steps_to_plane(of_field.field, *through, steps, ray);
      if (!to_plane) continue;
      const bool forwards = through->way[axis] > 0;
      ++told[axis];
      misplaced[axis] +=
          lies_as_said(forwards ? ray.before : ray.samples - ray.before, ray.samples, *to_plane) ? 0 : 1;
    }
  }
  std::optional<double> most;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (told[axis] >= fewest_rays)
      most = std::max(most.value_or(0), double(misplaced[axis]) / double(told[axis]));
  }
  return most;
}

}  // namespace understudy::spu
