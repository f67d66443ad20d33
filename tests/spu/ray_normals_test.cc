// SPDX-License-Identifier: Apache-2.0
// Normals of a ray's samples in linear fields.
#include "spu/volume/proxy/ray_normals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "spu/volume/proxy/light_space.h"
#include "spu/volume/proxy/step_fit.h"

namespace understudy::spu {
namespace {

/// Twenty steps through a unit cube, along x.
volume::RaySteps steps_along_x() {
  volume::RaySteps steps;
  steps.metric = {20, 0, 0, 0, 20, 0, 0, 0, 20};
  return steps;
}

const WayThroughBox along_x{{0, 0.5, 0.5}, {1, 0, 0}};

/// Samples of equal opacity.
std::vector<double> of_opacity(double opacity) {
  return std::vector<double>(places_on_way(steps_along_x(), along_x.way).size(), opacity);
}

double shares(const std::vector<NormalShare>& normals) {
  return std::accumulate(normals.begin(), normals.end(), 0.0,
                         [](double sum, const NormalShare& normal) { return sum + normal.share; });
}

TEST(RayNormals, AreOneWhereNoEndIsWithinReach) {
  const LightSpace space(volume::Light{}, along_x.way);
  const auto normals = ray_normals(along_x, steps_along_x(), of_opacity(0.03), space,
                                   {{0, 1, 0}, {32, 32, 32}, {0.1, 0.1, 0.1}});
  ASSERT_EQ(normals.size(), 1U);
  EXPECT_NEAR(*normals[0].cosine, 0, 1e-12);
  EXPECT_NEAR(normals[0].share, 1, 1e-12);
}

TEST(RayNormals, TurnNearTheEnds) {
  const LightSpace space(volume::Light{}, along_x.way);
  // Within a tenth of both ends, differences along x are smaller.
  const auto normals = ray_normals(along_x, steps_along_x(), of_opacity(0.03), space,
                                   {{1, 1, 0}, {1000, 1000, 1000}, {0.1, 0.1, 0.1}});
  ASSERT_GT(normals.size(), 3U);
  EXPECT_NEAR(shares(normals), 1, 1e-12);
  EXPECT_NEAR(*normals.front().cosine, 0.5 / std::hypot(0.5, 1), 0.01);
  const auto most = std::ranges::max_element(normals, {}, [](const NormalShare& n) { return n.share; });
  EXPECT_NEAR(*most->cosine, std::sqrt(0.5), 1e-9);
  EXPECT_GT(most->share, 0.7);
}

TEST(RayNormals, AreNoneWhereNothingRises) {
  const LightSpace space(volume::Light{}, along_x.way);
  // The first sample and its neighbours lie in the half texel at the end, where the field is constant.
  const auto normals =
      ray_normals(along_x, steps_along_x(), of_opacity(0.03), space, {{1, 0, 0}, {4, 4, 4}, {0.1, 0.1, 0.1}});
  EXPECT_FALSE(normals.front().cosine);
  EXPECT_TRUE(normals[1].cosine);
}

TEST(RayNormals, CountForAsMuchAsIsSeenOfTheirSamples) {
  const LightSpace space(volume::Light{}, along_x.way);
  const EvenRise field{{1, 1, 0}, {1000, 1000, 1000}, {0.1, 0.1, 0.1}};
  const double thin = ray_normals(along_x, steps_along_x(), of_opacity(0.001), space, field).front().share;
  const double dense = ray_normals(along_x, steps_along_x(), of_opacity(0.5), space, field).front().share;
  // Of n samples with opacity a, the first has the share a / (1 - (1 - a)^n).
  EXPECT_NEAR(thin, 1 / 21.0, 0.001);
  EXPECT_NEAR(dense, 0.5, 1e-6);
}

TEST(RayNormals, CountForLessBehindOpaqueSamples) {
  const LightSpace space(volume::Light{}, along_x.way);
  const EvenRise field{{1, 1, 0}, {1000, 1000, 1000}, {0.1, 0.1, 0.1}};
  std::vector<double> opacities = of_opacity(0);
  opacities[0] = 0.5;
  opacities[10] = 1;
  opacities[15] = 1;  // hidden
  const auto normals = ray_normals(along_x, steps_along_x(), opacities, space, field);
  EXPECT_NEAR(normals.front().share, 0.5, 1e-12);
  EXPECT_NEAR(shares(normals), 1, 1e-12);
}

TEST(RayNormals, GiveAMeanOfWhatTheLightMakes) {
  volume::Light light;
  light.even = {0.5F, 0.5F, 0.5F};
  light.ambient = {0, 0, 0};
  light.diffuse = light.specular = {1, 1, 1};
  light.response = {{0, 0}, {0, 0}, {1, 0.5F}};
  const std::vector<NormalShare> normals{{1.0, 0.25}, {-1.0, 0.25}, {std::nullopt, 0.5}};
  const Tint lit = lit_tint(light, normals, {0.4, 0.2, 0});
  EXPECT_NEAR(lit[0], 0.25 * (0.4 + 0.5) + 0.5 * 0.2, 1e-12);
  EXPECT_NEAR(lit[2], 0.25 * 0.5, 1e-12);
}

TEST(RayNormals, AreShorterWhereAGuardKeepsThemFromADivisionByZero) {
  const LightSpace space(volume::Light{}, along_x.way);
  const EvenRise field{{-2, 0, 0}, {1000, 1000, 1000}, {0.1, 0.1, 0.1}};
  // The sample with the largest share, away from the texture's ends.
  const auto cosine = [&](const volume::NormalGuard& guard) {
    const auto normals = ray_normals(along_x, steps_along_x(), of_opacity(0.03), space, field, guard);
    return std::abs(*std::ranges::max_element(normals, {}, &NormalShare::share)->cosine);
  };
  EXPECT_NEAR(cosine({}), 1, 1e-12);
  EXPECT_NEAR(cosine({0.5, volume::NormalGuard::Form::added}), 2 / 2.5, 1e-9);
  EXPECT_NEAR(cosine({2.5, volume::NormalGuard::Form::larger}), 2 / 2.5, 1e-9);
  EXPECT_NEAR(cosine({1.5, volume::NormalGuard::Form::root_of_squares}), 2 / 2.5, 1e-9);
}

}  // namespace
}  // namespace understudy::spu
