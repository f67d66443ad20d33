// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/exit_steps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "spu/volume/proxy/step_fit.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::spu {
namespace {

/// In steps: keeps the sample at the exit itself from being lost to rounding.
constexpr double exit_rounding = 1e-3;

}  // namespace

bool may_be_counted_from_exit(const volume::RaySteps& steps) {
  return !steps.divided && !steps.counted_from && !steps.at_least_one && steps.first < 1 - 2 * exit_rounding;
}

volume::RaySteps counted_from_exit(const volume::RaySteps& steps, const RaysThroughBox& rays,
                                   const volume::Rect& viewport, const volume::Rect& rect) {
  constexpr auto no_sample = float(volume::max_planes);  // begins beyond the end of every ray
  if (rect.empty()) return steps;
  volume::RaySteps counted = steps;
  counted.first = 0;
  volume::RayOffsets offsets{rect.width, rect.height, std::vector<float>(rect.pixels(), no_sample)};
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    for (int x = rect.x; x < rect.x + rect.width; ++x) {
      const auto way = rays.way(2 * (x + 0.5 - viewport.x) / viewport.width - 1,
                                2 * (y + 0.5 - viewport.y) / viewport.height - 1);
      const double to_last = way ? steps_of_way(steps, *way) - steps.first : -1;
      if (to_last < 0) continue;
      const auto column = std::size_t((x % rect.width + rect.width) % rect.width);
      const auto row = std::size_t((y % rect.height + rect.height) % rect.height);
      offsets.steps[row * std::size_t(rect.width) + column] =
          float(std::max(0.0, to_last - std::floor(to_last) - exit_rounding));
    }
  }
  counted.offsets = std::move(offsets);
  return counted;
}

volume::RaySteps counted_from_exit(const volume::RaySteps& steps, const RaysThroughBox& rays,
                                   const FieldProbe& probe) {
  const volume::Rect viewport{probe.left(), probe.bottom(), probe.width(), probe.height()};
  return counted_from_exit(steps, rays, viewport, viewport);
}

}  // namespace understudy::spu
