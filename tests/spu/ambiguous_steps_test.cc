// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/ambiguous_steps.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace understudy::spu::testing {
namespace {

using Metric = std::array<double, 9>;
using volume::Vec3;

/// Constant steps, for axes of length `axes`, that give `steps` steps along `way`.
Metric counting(const Vec3& axes, const Vec3& way, double steps) {
  const double length = std::hypot(axes[0] * way[0], axes[1] * way[1], axes[2] * way[2]);
  Metric metric{};
  for (std::size_t k = 0; k < 3; ++k) metric[4 * k] = axes[k] * steps / length;
  return metric;
}

const Vec3 texels{64, 64, 32}, world{1, 1, 1.5};
const Vec3 first_view{0.3, 0.9, 0.5}, turned_view{0.8, 0.5, 0.1};

TEST(AmbiguousSteps, AreToldByAnotherView) {
  const std::vector<Metric> alike{counting(texels, first_view, 50), counting(world, first_view, 50)};
  volume::RaySteps steps;
  steps.metric = alike.front();
  EXPECT_FALSE(tells_apart(alike, steps, first_view));
  EXPECT_TRUE(tells_apart(alike, steps, turned_view));
  EXPECT_FALSE(tells_apart({alike.data(), 1}, steps, turned_view)) << "one is not ambiguous";
}

TEST(AmbiguousSteps, AreToldByAQuarterOfAStepAsLongAsStepsAreNow) {
  const Vec3 slightly{0.31, 0.9, 0.49};
  const std::vector<Metric> alike{counting(texels, first_view, 50), counting(world, first_view, 50)};
  volume::RaySteps steps;
  steps.metric = alike.front();
  EXPECT_TRUE(tells_apart(alike, steps, slightly));
  for (double& number : steps.metric) number /= 20;  // steps of 20 times the length
  EXPECT_FALSE(tells_apart(alike, steps, slightly));
}

TEST(AmbiguousSteps, AreThoseThatCountAsEarlierViewsDid) {
  const Metric truth = counting(world, first_view, 50);
  volume::RaySteps steps;
  steps.metric = truth;
  const double in_turned = steps_of_way(steps, turned_view);
  const std::vector<StepFit> fits{{.metric = counting(texels, turned_view, in_turned)},
                                  {.metric = counting(world, turned_view, in_turned)}};
  const std::vector<MeasuredWay> ways{{first_view, 50}};
  EXPECT_FALSE(count_as_measured(fits[0].metric, ways));
  const std::vector<StepFit> left = that_count_as_measured(fits, ways);
  ASSERT_EQ(left.size(), 1U);
  EXPECT_EQ(left.front().metric, fits[1].metric);
}

TEST(AmbiguousSteps, AreAllWhereNoneCountsAsBefore) {
  const std::vector<StepFit> fits{{.metric = counting(texels, turned_view, 20)},
                                  {.metric = counting(world, turned_view, 20)}};
  const std::vector<MeasuredWay> ways{{first_view, 500}};
  EXPECT_EQ(that_count_as_measured(fits, ways).size(), 2U);
  EXPECT_TRUE(count_as_measured(fits[0].metric, {})) << "nothing was measured before";
}

}  // namespace
}  // namespace understudy::spu::testing
