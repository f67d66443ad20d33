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

/// A ray of equal samples ended with the one that made it so opaque: the limit is above `before`, and no more
/// than `ended`.
struct EndedRay {
  double before = 0;
  double ended = 1;
  bool allows(double limit) const { return limit > before && limit <= ended; }
};

/// The number of fewest digits, which people write, of those that explain most rays; null where no number
/// explains nearly all. (What a table's entry was measured to be may be another one where it is steep.)
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

}  // namespace

float opacity_limit(const March& march, const volume::RaySteps& steps, FieldProbe& probe,
                    const RaysThroughBox& rays) {
  constexpr float least_limit = 0.5F;
  constexpr float highest_limit = 0.99F;
  constexpr float thinnest = 0.02F;  // samples whose number an opacity tells
  constexpr float densest = 0.4F;
  constexpr double rounding = 2e-4;
  constexpr double uneven = 0.1;           // of a number of samples
  constexpr double fewest_left_out = 2.5;  // samples; noise may move a ray by one
  if (march.shows_one_colour() || march.sum || march.background) return 1;
  const auto middle = rays.middle();
  const auto way = rays.way(middle[0], middle[1]);
  if (!way) return 1;
  const double samples = samples_of_length(steps, steps_of_way(steps, *way));
  const std::vector<float> values = values_over({march.table.low, march.table.high});
  const std::vector<Rgba> through = probe.at(middle[0], middle[1], values);
  std::vector<EndedRay> ended_early;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float sample = table_at(march.table, values[i])[3];
    const float ended = through[i][3];
    if (!reached(through[i]) || !(sample >= thinnest && sample <= densest) || !(ended < 1)) continue;
    const double each = std::log1p(-double(sample));
    const double taken = std::log1p(-double(ended)) / each;
    if (std::abs(taken - std::round(taken)) > uneven || taken + fewest_left_out > samples) continue;
    ended_early.push_back({-std::expm1((std::round(taken) - 1) * each) + rounding, double(ended) + rounding});
  }
  const float limit = explained_by(ended_early).value_or(1);
  return limit >= least_limit && limit < highest_limit ? limit : 1;
}

}  // namespace understudy::spu
