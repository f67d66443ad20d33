// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/extreme_steps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/step_density.h"
#include "spu/volume/proxy/step_fit.h"
#include "spu/volume/proxy/step_spaces.h"
#include "volume/matrix.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

constexpr int ramp_bands = 8;  ///< of two rows each
constexpr std::size_t fewest_rays = 64;

/// A range of the table's entries over which one channel only rises, or only falls, and so determines the
/// value.
class TellingStretch {
 public:
  /// Returns the stretch over which a channel changes most; null if none changes by more than 0.2.
  static std::optional<TellingStretch> of(const volume::TransferFunction& table);

  /// The values between which fields rise. They lie inside the stretch, as at its very ends a colour may also
  /// stand for other values.
  float low() const { return value_of(double(first_) + margin * double(last_ - first_)); }
  float high() const { return value_of(double(last_) - margin * double(last_ - first_)); }

  /// Returns the place of the value with this colour, from low() (0) to high() (1); null if the colour does not
  /// determine it.
  std::optional<double> place_of(const Rgba& colour) const {
    constexpr float rounding = 1e-3F;
    constexpr double widest = 0.02;  // of the stretch: beyond this, one colour has too many values
    const auto begin = rising_.begin();
    const float told = sign_ * colour[channel_];
    const auto from = std::lower_bound(begin, rising_.end(), told - rounding);
    const auto to = std::upper_bound(begin, rising_.end(), told + rounding);
    const double extent = double(rising_.size()) - 1;
    if (from == rising_.begin() || to == rising_.end() || double(to - from) > widest * extent)
      return std::nullopt;
    // Where the table is flat, take the middle of the flat part.
    const double middle = (entry_at(told - flat) + entry_at(told + flat)) / 2;
    return (middle / extent - margin) / (1 - 2 * margin);
  }

 private:
  TellingStretch(const volume::TransferFunction& table, std::size_t channel, float sign, std::size_t first,
                 std::size_t last)
      : low_(table.low),
        high_(table.high),
        entries_(table.entries.size()),
        channel_(channel),
        sign_(sign),
        first_(first),
        last_(last) {
    for (std::size_t i = first; i <= last; ++i) rising_.push_back(sign * table.entries[i][channel]);
  }
  /// The fractional entry at which the channel reaches this value.
  double entry_at(float told) const {
    const auto above = std::upper_bound(rising_.begin() + 1, rising_.end() - 1, told);
    const float rise = *above - above[-1];
    const double part = rise > 0 ? std::clamp((told - above[-1]) / rise, 0.0F, 1.0F) : 0.5;
    return double(above - rising_.begin()) - 1 + part;
  }
  float value_of(double entry) const { return value_at({low_, high_}, entry / double(entries_ - 1)); }

  static constexpr double margin = 0.05;
  static constexpr float flat = 1e-5F;  ///< smaller changes do not determine a value

  float low_, high_;
  std::size_t entries_;
  std::size_t channel_;
  float sign_;
  std::size_t first_, last_;
  std::vector<float> rising_;
};

std::optional<TellingStretch> TellingStretch::of(const volume::TransferFunction& table) {
  float most = 0.2F;
  std::optional<TellingStretch> best;
  for (std::size_t channel = 0; channel < 4; ++channel) {
    for (const float sign : {1.0F, -1.0F}) {
      const auto at = [&](std::size_t entry) { return sign * table.entries[entry][channel]; };
      for (std::size_t first = 0, last = 0; last + 1 < table.entries.size(); ++last) {
        if (at(last + 1) < at(last) - flat) first = last + 1;
        // A flat part before the rise does not determine the value.
        if (at(last + 1) <= at(first) + flat) first = last + 1;
        if (at(last + 1) - at(first) <= most || at(last + 1) <= at(last) + flat) continue;
        most = at(last + 1) - at(first);
        best = TellingStretch(table, channel, sign, first, last + 1);
      }
    }
  }
  return best;
}

/// Adds the ends of those rays in some rows whose path is longest along `axis`.
void add_ends(FieldProbe& probe, const TellingStretch& stretch, const RaysThroughBox& rays, std::size_t axis,
              bool premultiplied_already, std::vector<RayEnds>& ends) {
  for (int band = 0; band < ramp_bands; ++band) {
    const int y =
        std::clamp((2 * band + 1) * probe.height() / (2 * ramp_bands), 0, std::max(0, probe.height() - 2));
    const auto rising = probe.rows(y, 2, FieldProbe::RampField{axis, stretch.low(), stretch.high()});
    const auto falling = probe.rows(y, 2, FieldProbe::RampField{axis, stretch.high(), stretch.low()});
    for (std::size_t i = 0; i < rising.size(); ++i) {
      if (!reached(rising[i]) || !reached(falling[i])) continue;
      const int column = int(i) % probe.width();
      const int row = y + int(i) / probe.width();
      const auto through = rays.through(probe.x_of(column), probe.y_of(row));
      if (!through) continue;
      const volume::Vec3& way = through->way;
      const double longest = std::max({std::abs(way[0]), std::abs(way[1]), std::abs(way[2])});
      if (std::abs(way[axis]) < longest) continue;
      const auto one = stretch.place_of(premultiplied(rising[i], premultiplied_already));
      const auto other = stretch.place_of(premultiplied(falling[i], premultiplied_already));
      if (!one || !other) continue;
      const double a = (*one - through->entry[axis]) / way[axis];
      const double b = (1 - *other - through->entry[axis]) / way[axis];
      ends.push_back({way, std::min(a, b), std::max(a, b), probe.left() + column, probe.bottom() + row});
    }
  }
}

/// Returns steps of one length where the texture's axes are `axes` long. Their number per unit comes
/// approximately from the ends of the paths, and then exactly from the number of samples on each ray.
std::optional<volume::RaySteps> steps_in(const std::vector<RayEnds>& ends, const volume::Vec3& axes) {
  std::vector<SampledWay> ways;
  for (const RayEnds& ray : ends) {
    const double length = volume::length({ray.way[0] * axes[0], ray.way[1] * axes[1], ray.way[2] * axes[2]});
    ways.push_back({length, (ray.last - ray.first) * length, (1 - ray.last) * length});
  }
  const auto density = step_density(ways);
  if (!density) return std::nullopt;
  std::vector<CountedRay> counted;
  for (std::size_t i = 0; i < ends.size(); ++i)
    counted.push_back({ends[i].way, std::round(*density * ways[i].sampled) + 1});
  for (const StepFit& fit : fit_steps(counted, {&axes, 1})) {
    const volume::RaySteps steps = rules_of(fit).front();
    if (fit.unexplained <= most_unexplained && lie_on(steps, ends)) return steps;
  }
  return std::nullopt;
}

}  // namespace

bool lie_on(const volume::RaySteps& steps, std::span<const RayEnds> ends) {
  constexpr double colours_of_8_bits = 0.3;  // of a step: imprecision of 8-bit colours
  constexpr double rounding = 0.05;
  constexpr double most_elsewhere = 0.05;
  const auto elsewhere = std::ranges::count_if(ends, [&](const RayEnds& ray) {
    const double length = steps_of_way(steps, ray.way);
    if (!(std::abs(ray.first * length - steps.first) <= colours_of_8_bits)) return true;
    return std::ranges::none_of(std::array{0.0, -rounding, rounding}, [&](double nudge) {
      const double last = steps.first + samples_of_length(steps, length + nudge) - 1;
      return std::abs(ray.last * length - last) <= colours_of_8_bits;
    });
  });
  return double(elsewhere) <= most_elsewhere * double(ends.size());
}

std::vector<RayEnds> ends_of_rays(const MarchContext& measured, FieldProbe& probe,
                                  const volume::TransferFunction& table, const ProxyBox& box) {
  constexpr std::size_t most_rays = 512;
  const auto stretch = TellingStretch::of(table);
  if (!stretch || !box.cuts.empty()) return {};
  const RaysThroughBox rays(box.camera.texture_to_clip, box.region);
  std::vector<RayEnds> all;
  for (const std::size_t axis : {0U, 1U, 2U})
    add_ends(probe, *stretch, rays, axis, measured.run.pipeline().blending.premultiplied, all);
  if (all.size() < fewest_rays) return {};
  std::vector<RayEnds> ends;
  const std::size_t every = (all.size() + most_rays - 1) / most_rays;
  for (std::size_t i = 0; i < all.size(); i += every) ends.push_back(all[i]);
  return ends;
}

std::vector<volume::RaySteps> steps_of(const std::vector<RayEnds>& ends, const MarchContext& measured,
                                       const FieldProbe& probe, const ProxyBox& box) {
  std::vector<volume::RaySteps> found;
  if (ends.empty()) return found;
  for (const volume::Vec3& axes : step_spaces(measured.texture.size, box.camera.texture_to_clip, probe)) {
    const auto steps = steps_in(ends, axes);
    if (steps && std::ranges::none_of(found, [&](const volume::RaySteps& other) {
          return other.first == steps->first && alike(other.metric, steps->metric);
        }))
      found.push_back(*steps);
  }
  return found;
}

}  // namespace understudy::spu
