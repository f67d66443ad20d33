// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/opacity_limit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "spu/volume/classification/table_lookup.h"
#include "spu/volume/proxy/ray_colours.h"
#include "spu/volume/proxy/step_fit.h"

namespace understudy::spu {

using volume::Rgba;

namespace {

/// A ray of equal samples that was terminated by the sample that made it so opaque: the limit is above
/// `before`, and no more than `ended`.
struct EndedRay {
  double before = 0;
  double ended = 1;
  bool made_opaque = false;  ///< the program writes an alpha of 1 for it
  bool allows(double limit) const { return limit > before && limit <= ended; }
};

/// Returns, of the limits that explain most rays, the one of fewest digits, as people write them; null if no
/// limit explains nearly all. (Where the table is steep, an entry may have been measured inexactly.)
std::optional<float> explained_by(const std::vector<EndedRay>& rays) {
  constexpr std::size_t fewest = 3;
  constexpr double nearly_all = 0.8;
  std::optional<float> plainest;
  std::ptrdiff_t most = 0;
  for (const int parts : {10, 100, 1000}) {
    for (int i = 1; i < parts; ++i) {
      const double limit = double(i) / parts;
      const auto explained =
          std::ranges::count_if(rays, [&](const EndedRay& ray) { return ray.allows(limit); });
      if (explained <= most) continue;
      most = explained;
      plainest = float(limit);
    }
  }
  if (rays.size() < fewest || double(most) < nearly_all * double(rays.size())) return std::nullopt;
  return plainest;
}

/// Returns how opaque a ray's samples are, by its colour: some programs write another alpha where they
/// terminate rays. Null if the value is black.
std::optional<double> opacity_by_colour(const Rgba& ray, const Rgba& sample) {
  const std::size_t c = std::size_t(std::max_element(sample.begin(), sample.begin() + 3) - sample.begin());
  if (!(sample[c] > 0)) return std::nullopt;
  return double(ray[c]) * double(sample[3]) / double(sample[c]);
}

/// Rays of one value through the middle of the view.
class EqualSamples {
 public:
  EqualSamples(const March& march, double samples) : samples_(samples), over_background_(march.background) {}

  /// Null if the ray was not terminated early, or if its samples cannot be counted. Both arguments are
  /// premultiplied.
  std::optional<EndedRay> ended_early(const Rgba& ray, const Rgba& sample) const;

 private:
  double samples_;  ///< of a ray that is not terminated early
  bool over_background_;
};

std::optional<EndedRay> EqualSamples::ended_early(const Rgba& ray, const Rgba& sample) const {
  constexpr float thinnest = 0.02F;  // opacity range of samples that can be counted
  constexpr float densest = 0.4F;
  constexpr double fewest_left_out = 2.5;  // samples; noise may move a ray by one
  constexpr double uneven = 0.1;           // deviation from a whole number of samples
  constexpr double rounding = 2e-4;
  // A ray is seen less exactly over the program's own background.
  constexpr double rounding_over_background = 2e-3;
  constexpr double opaque = 1 - 1e-4;
  if (!reached(ray) || !(ray[3] > 0) || !(sample[3] >= thinnest && sample[3] <= densest)) return std::nullopt;
  EndedRay ended{.ended = double(ray[3]), .made_opaque = ray[3] >= 1};
  if (ended.made_opaque) ended.ended = opacity_by_colour(ray, sample).value_or(1);
  if (!(ended.ended < (ended.made_opaque ? opaque : 1))) return std::nullopt;
  const double each = std::log1p(-double(sample[3]));
  const double taken = std::log1p(-ended.ended) / each;
  if (taken + fewest_left_out > samples_) return std::nullopt;
  if (over_background_) {
    ended.before = 1 - (1 - ended.ended) / (1 - double(sample[3])) - rounding_over_background;
    ended.ended += rounding_over_background;
    return ended;
  }
  if (std::abs(taken - std::round(taken)) > uneven) return std::nullopt;
  ended.before = -std::expm1((std::round(taken) - 1) * each) + rounding;
  ended.ended += rounding;
  return ended;
}

}  // namespace

void take_opacity_limit(const MarchContext& measured, const volume::RaySteps& steps, FieldProbe& probe,
                        const RaysThroughBox& rays, March& march) {
  constexpr float least_limit = 0.5F;
  constexpr float highest_limit = 0.9995F;
  march.opacity_limit = 1;
  march.opaque_at_limit = false;
  if (march.shows_one_colour() || march.sum) return;
  const auto middle = rays.middle();
  const auto way = rays.way(middle[0], middle[1]);
  if (!way) return;
  const EqualSamples equal(march, samples_of_length(steps, steps_of_way(steps, *way)));
  const std::vector<float> values = values_over({march.table.low, march.table.high});
  const std::vector<Rgba> through = probe.at(middle[0], middle[1], values);
  const bool already = premultiplied_already(measured, march);
  std::vector<EndedRay> ended_early;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto ended = equal.ended_early(premultiplied(through[i], already), table_at(march.table, values[i]));
    if (ended) ended_early.push_back(*ended);
  }
  const float limit = explained_by(ended_early).value_or(1);
  if (!(limit >= least_limit && limit < highest_limit)) return;
  march.opacity_limit = limit;
  march.opaque_at_limit =
      2 * std::ranges::count_if(ended_early, &EndedRay::made_opaque) > std::ranges::ssize(ended_early);
}

}  // namespace understudy::spu
