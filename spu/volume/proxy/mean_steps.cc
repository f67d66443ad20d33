// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/mean_steps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/sample_places.h"
#include "volume/matrix.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

/// Two values, and the channel in which their colours differ most.
struct ValueContrast {
  std::size_t one = 0;
  std::size_t other = 0;
  std::size_t channel = 0;
  float difference = 0;

  /// The fraction of the first colour in a mixture of both.
  double part_of_one(const std::vector<Rgba>& colours, const Rgba& mixture) const {
    return (double(mixture[channel]) - double(colours[other][channel])) / double(difference);
  }
};

ValueContrast greatest_contrast(const std::vector<Rgba>& colours) {
  ValueContrast greatest;
  for (std::size_t channel = 0; channel < 4; ++channel) {
    const auto [low, high] =
        std::ranges::minmax_element(colours, {}, [&](const Rgba& colour) { return colour[channel]; });
    const float difference = (*high)[channel] - (*low)[channel];
    if (difference > greatest.difference)
      greatest = {std::size_t(high - colours.begin()), std::size_t(low - colours.begin()), channel, difference};
  }
  return greatest;
}

/// Returns how many samples a fragment's ray has, one of which lies in a layer of another value. Null if none
/// does; 0 if the number is not whole.
class SamplesByColours {
 public:
  SamplesByColours(const ValueContrast& contrast, const std::vector<Rgba>& colours)
      : contrast_(contrast), colours_(colours) {}

  std::optional<double> operator()(const Rgba& fragment) const {
    constexpr double most_samples = 4096;
    constexpr double whole = 0.1;
    const double part = contrast_.part_of_one(colours_, fragment);
    if (!(part * most_samples >= 1)) return std::nullopt;
    const double samples = std::round(1 / part);
    return std::abs(1 / part - samples) <= whole ? samples : 0;
  }

 private:
  ValueContrast contrast_;
  const std::vector<Rgba>& colours_;
};

/// Likewise for a mean of values. Its colours for all numbers of samples are drawn in advance, as constant
/// fields.
class SamplesByValues {
 public:
  /// From `fewest` samples to 32 times as many, the mean goes from `within` nearly to `outside`.
  SamplesByValues(FieldProbe& probe, const std::array<double, 2>& ray, float within, float outside, int fewest)
      : fewest_(fewest) {
    std::vector<float> means{outside};
    for (int n = fewest; n <= 32 * fewest; ++n)
      means.push_back(float(outside + (double(within) - outside) * fewest / n));
    by_samples_ = probe.at(ray[0], ray[1], means);
  }

  std::optional<double> operator()(const Rgba& fragment) const {
    constexpr float nearly = 0.25F;  // of the difference between neighbouring numbers of samples
    const float to_none = largest_difference(fragment, by_samples_.front());
    if (!(to_none > largest_difference(by_samples_.back(), by_samples_.front()) / 2)) return std::nullopt;
    std::size_t told = 0;
    for (std::size_t i = 2; i + 1 < by_samples_.size(); ++i) {
      const float apart = std::min(largest_difference(by_samples_[i], by_samples_[i - 1]),
                                   largest_difference(by_samples_[i], by_samples_[i + 1]));
      if (!(largest_difference(fragment, by_samples_[i]) < nearly * apart)) continue;
      if (told != 0) return 0;  // one colour fits several numbers
      told = i;
    }
    return told == 0 ? 0 : double(fewest_) + double(told) - 1;
  }

 private:
  int fewest_;
  std::vector<Rgba> by_samples_;  ///< with no sample in the layer, with the fewest, with one more, and so on
};

/// Counts the samples of rays that have one sample in a layer of another value.
class LayerCounting {
 public:
  using Samples = std::function<std::optional<double>(const Rgba&)>;

  LayerCounting(FieldProbe& probe, const ProxyBox& box, Samples samples)
      : probe_(probe), rays_(box.camera.texture_to_clip, box.region, box.cuts), samples_(std::move(samples)) {}

  /// Uses layers at several places, across each axis, until enough rays are counted: in a small window, few
  /// rays have a sample in one.
  std::vector<CountedRay> count(const volume::Box& region, float within, float outside) {
    constexpr std::size_t enough = 512;
    constexpr double most_broken = 0.1;
    for (const double part : {0.45, 0.55, 0.37, 0.62, 0.51, 0.41, 0.58, 0.34, 0.66, 0.48, 0.53, 0.39}) {
      for (const std::size_t axis : {0U, 1U, 2U}) {
        const double place = (1 - part) * region.low[axis] + part * region.high[axis];
        add({axis, place, within, outside});
      }
      if (counted_.size() + broken_ >= enough) break;
    }
    if (double(broken_) > most_broken * double(counted_.size())) counted_.clear();
    return std::move(counted_);
  }

 private:
  void add(const FieldProbe::LayerField& field) {
    constexpr int bands = 16;  // of two rows each
    for (int band = 0; band < bands; ++band) {
      const int y = (2 * band + 1) * probe_.height() / (2 * bands);
      add_rows(std::clamp(y, 0, std::max(0, probe_.height() - 2)), field);
    }
  }

  void add_rows(int first_row, const FieldProbe::LayerField& field) {
    constexpr double least_across = 0.3;  // of a ray's path: grazing rays have several samples in the layer
    const auto fragments = probe_.rows(first_row, 2, field);
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      if (!reached(fragments[i])) continue;
      const auto samples = samples_(fragments[i]);
      if (!samples) continue;
      const int column = int(i) % probe_.width();
      const int row = first_row + int(i) / probe_.width();
      const auto way = rays_.way(probe_.x_of(column), probe_.y_of(row));
      if (!way || std::abs((*way)[field.axis]) < least_across * volume::length(*way)) continue;
      if (*samples < 1)
        ++broken_;
      else
        counted_.push_back({*way, *samples, probe_.left() + column, probe_.bottom() + row});
    }
  }

  FieldProbe& probe_;
  RaysThroughBox rays_;
  Samples samples_;
  std::vector<CountedRay> counted_;
  std::size_t broken_ = 0;  ///< rays whose number of samples is not whole
};

}  // namespace

bool shows_mean(FieldProbe& probe, const ProxyBox& box, const std::vector<float>& values,
                const std::vector<Rgba>& colours) {
  constexpr float least_contrast = 0.02F;
  constexpr double clearly = 0.1;  // of the contrast
  const ValueContrast contrast = greatest_contrast(colours);
  if (!(contrast.difference >= least_contrast)) return false;
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  const auto middle = rays.middle();
  const int column = probe.column_at(middle[0]);
  const int row = probe.row_at(middle[1]);
  const auto way = rays.way(probe.x_of(column), probe.y_of(row));
  if (!way) return false;
  for (const auto& field : split_fields(box.region, *way, values[contrast.one], values[contrast.other])) {
    const Rgba seen = probe.pixel(column, row, field);
    if (!reached(seen)) continue;
    const double part = contrast.part_of_one(colours, seen);
    if (part > clearly && part < 1 - clearly) return true;
  }
  return false;
}

std::vector<CountedRay> counted_by_means(FieldProbe& probe, const ProxyBox& box, Mean mean,
                                         const std::vector<float>& values, const std::vector<Rgba>& colours) {
  constexpr std::size_t fewest_rays = 64;
  const ValueContrast contrast = greatest_contrast(colours);
  if (!(contrast.difference > 0)) return {};
  const float within = values[contrast.one], outside = values[contrast.other];
  if (mean == Mean::of_colours)
    return LayerCounting(probe, box, SamplesByColours(contrast, colours)).count(box.region, within, outside);
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  for (const int fewest : {16, 4, 64}) {
    LayerCounting counting(probe, box, SamplesByValues(probe, rays.middle(), within, outside, fewest));
    // One sample in the layer changes the mean as much as that many of the value `within` would.
    auto counted = counting.count(box.region, outside + float(fewest) * (within - outside), outside);
    if (counted.size() >= fewest_rays) return counted;
  }
  return {};
}

bool have_as_many(const std::vector<CountedRay>& rays, const volume::RaySteps& steps) {
  constexpr double rounding = 0.08;  // of a step
  constexpr double most_others = 0.05;
  const auto others = std::ranges::count_if(rays, [&](const CountedRay& ray) {
    const double length = steps_of_way(steps, ray.way);
    return std::ranges::none_of(std::array{0.0, -rounding, rounding}, [&](double nudge) {
      return samples_of_length(steps, length + nudge) == ray.samples;
    });
  });
  return double(others) <= most_others * double(rays.size());
}

}  // namespace understudy::spu
