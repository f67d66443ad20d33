// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/mean_steps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/sample_places.h"
#include "volume/matrix.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

/// Two values and the channel by which their colours are told apart best.
struct Contrast {
  std::size_t one = 0;
  std::size_t other = 0;
  std::size_t channel = 0;
  float difference = 0;

  /// Which part of a mixture of both colours is that of the first.
  double part_of_one(const std::vector<Rgba>& colours, const Rgba& mixture) const {
    return (double(mixture[channel]) - double(colours[other][channel])) / double(difference);
  }
};

Contrast greatest_contrast(const std::vector<Rgba>& colours) {
  Contrast greatest;
  for (std::size_t channel = 0; channel < 4; ++channel) {
    const auto [low, high] =
        std::ranges::minmax_element(colours, {}, [&](const Rgba& colour) { return colour[channel]; });
    const float difference = (*high)[channel] - (*low)[channel];
    if (difference > greatest.difference)
      greatest = {std::size_t(high - colours.begin()), std::size_t(low - colours.begin()), channel, difference};
  }
  return greatest;
}

/// Counts the samples of rays that have one in a layer of another value.
class LayerCounting {
 public:
  LayerCounting(FieldProbe& probe, const ProxyBox& box, const Contrast& contrast,
                const std::vector<Rgba>& colours)
      : probe_(probe),
        rays_(box.camera.texture_to_clip, box.region, box.cuts),
        contrast_(contrast),
        colours_(colours) {}

  void add(const FieldProbe::LayerField& field) {
    constexpr int bands = 16;  // of two rows each
    for (int band = 0; band < bands; ++band) {
      const int y = (2 * band + 1) * probe_.height() / (2 * bands);
      add_rows(std::clamp(y, 0, std::max(0, probe_.height() - 2)), field);
    }
  }

  std::vector<CountedRay> counted;
  std::size_t broken = 0;  ///< rays whose number of samples is no whole one

 private:
  void add_rows(int first_row, const FieldProbe::LayerField& field) {
    constexpr double most_samples = 4096;
    constexpr double whole = 0.1;
    constexpr double least_across =
        0.3;  // of a ray's way: several samples of one that grazes the layer lie in it
    const auto fragments = probe_.rows(first_row, 2, field);
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      if (!reached(fragments[i])) continue;
      const double part = contrast_.part_of_one(colours_, fragments[i]);
      if (!(part * most_samples >= 1)) continue;  // no sample lies in it
      const int column = int(i) % probe_.width();
      const int row = first_row + int(i) / probe_.width();
      const auto way =
          rays_.way(2 * (column + 0.5) / probe_.width() - 1, 2 * (row + 0.5) / probe_.height() - 1);
      if (!way || std::abs((*way)[field.axis]) < least_across * volume::length(*way)) continue;
      const double samples = std::round(1 / part);
      if (std::abs(1 / part - samples) > whole)
        ++broken;
      else
        counted.push_back({*way, samples, probe_.left() + column, probe_.bottom() + row});
    }
  }

  FieldProbe& probe_;
  RaysThroughBox rays_;
  Contrast contrast_;
  const std::vector<Rgba>& colours_;
};

}  // namespace

bool shows_mean(FieldProbe& probe, const ProxyBox& box, const std::vector<float>& values,
                const std::vector<Rgba>& colours) {
  constexpr float least_contrast = 0.02F;
  constexpr double clearly = 0.1;  // of the contrast
  const Contrast contrast = greatest_contrast(colours);
  if (!(contrast.difference >= least_contrast)) return false;
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region, box.cuts);
  const auto middle = rays.middle();
  const int column = std::clamp(int((middle[0] + 1) / 2 * probe.width()), 0, probe.width() - 1);
  const int row = std::clamp(int((middle[1] + 1) / 2 * probe.height()), 0, probe.height() - 1);
  const auto way = rays.way(2 * (column + 0.5) / probe.width() - 1, 2 * (row + 0.5) / probe.height() - 1);
  if (!way) return false;
  for (const auto& field : split_fields(box.region, *way, values[contrast.one], values[contrast.other])) {
    const Rgba seen = probe.pixel(column, row, field);
    if (!reached(seen)) continue;
    const double part = contrast.part_of_one(colours, seen);
    if (part > clearly && part < 1 - clearly) return true;
  }
  return false;
}

std::vector<CountedRay> counted_by_means(FieldProbe& probe, const ProxyBox& box,
                                         const std::vector<float>& values, const std::vector<Rgba>& colours) {
  constexpr std::size_t enough = 512;
  constexpr double most_broken = 0.1;
  const Contrast contrast = greatest_contrast(colours);
  if (!(contrast.difference > 0)) return {};
  LayerCounting counting(probe, box, contrast, colours);
  // Through a small window few rays have a sample in a layer.
  for (const double part : {0.45, 0.55, 0.37, 0.62, 0.51, 0.41, 0.58, 0.34, 0.66, 0.48, 0.53, 0.39}) {
    for (const std::size_t axis : {0U, 1U, 2U}) {
      const double place = (1 - part) * box.region.low[axis] + part * box.region.high[axis];
      counting.add({axis, place, values[contrast.one], values[contrast.other]});
    }
    if (counting.counted.size() + counting.broken >= enough) break;
  }
  if (double(counting.broken) > most_broken * double(counting.counted.size())) return {};
  return std::move(counting.counted);
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
