// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/ambiguous_steps.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace understudy::spu {
namespace {

double length_of(const std::array<double, 9>& metric, const volume::Vec3& way) {
  volume::RaySteps steps;
  steps.metric = metric;
  return steps_of_way(steps, way);
}

}  // namespace

bool count_as_measured(const std::array<double, 9>& metric, std::span<const MeasuredWay> ways) {
  constexpr double same = 0.3;  // steps: precision of a fitted path length
  return std::ranges::all_of(ways, [&](const MeasuredWay& measured) {
    return std::abs(length_of(metric, measured.way) - measured.steps) <= same;
  });
}

std::vector<StepFit> that_count_as_measured(std::vector<StepFit> fits, std::span<const MeasuredWay> ways) {
  std::vector<StepFit> consistent;
  std::ranges::copy_if(fits, std::back_inserter(consistent),
                       [&](const StepFit& fit) { return count_as_measured(fit.metric, ways); });
  return consistent.empty() ? fits : consistent;
}

bool of_one_shape(const std::array<double, 9>& one, const std::array<double, 9>& other) {
  std::array<double, 9> scaled = other;
  const double factor = std::max({one[0], one[4], one[8]}) / std::max({other[0], other[4], other[8]});
  for (double& number : scaled) number *= factor;
  return alike(one, scaled);
}

bool tells_apart(std::span<const std::array<double, 9>> metrics, const volume::RaySteps& steps,
                 const volume::Vec3& way) {
  constexpr double told = 0.25;
  if (metrics.size() < 2) return false;
  const double own = length_of(metrics.front(), way);
  const double now = steps_of_way(steps, way);
  return std::ranges::any_of(metrics, [&](const std::array<double, 9>& metric) {
    return std::abs(length_of(metric, way) / own - 1) * now >= told;
  });
}

}  // namespace understudy::spu
