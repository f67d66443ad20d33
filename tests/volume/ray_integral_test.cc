// SPDX-License-Identifier: Apache-2.0
// Checks the integral without step size against closed forms before it serves as a reference.
#include "volume/reference/ray_integral.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/volume/scenes.h"
#include "volume/classification.h"
#include "volume/texel_type.h"
#include "volume/texture_filter.h"
#include "volume/texture_space.h"

namespace understudy::volume::testing {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// A ray of one stretch whose value increases from `begin` to `end`.
std::vector<Stretch> ramp(double begin, double end, double length) {
  Stretch stretch;
  stretch.length = length;
  stretch.value[0].c = {begin, end - begin, 0, 0};
  return {stretch};
}

/// A field that equals the position along a ray of `length`, in `pieces` equal stretches.
std::vector<Stretch> distance_ray(double length, int pieces) {
  std::vector<Stretch> ray;
  for (int i = 0; i < pieces; ++i) {
    Stretch stretch;
    stretch.length = length / pieces;
    stretch.value[0].c = {length * i / pieces, length / pieces, 0, 0};
    ray.push_back(stretch);
  }
  return ray;
}

Medium constant_medium(double extinction, double colour) {
  return Medium::of_rates(0, 1, {{{colour * extinction, 0, 0}, extinction}});
}

TEST(RayIntegral, OfConstantExtinctionIsAnExponential) {
  for (const double extinction : {0.0, 1e-12, 1e-3, 1.0, 37.0, 1e6, 1e12}) {
    const RayIntegral sum = ray_integral(ramp(0.5, 0.5, 2), constant_medium(extinction, 0.7));
    EXPECT_NEAR(sum.optical_depth, 2 * extinction > 745 ? sum.optical_depth : 2 * extinction,
                2e-13 * extinction);
    EXPECT_NEAR(sum.opacity(), -std::expm1(-2 * extinction), 1e-13 * std::min(1.0, 2 * extinction))
        << extinction;
    EXPECT_NEAR(sum.colour[0], -0.7 * std::expm1(-2 * extinction), 1e-12) << extinction;
  }
}

TEST(RayIntegral, OfLinearExtinctionIsAGaussian) {
  // extinction = 0.3 + 5 t over a length of 1.5.
  const Medium medium = Medium::of_rates(0, 1.5, {{{0, 0, 0}, 0.3}, {{0, 0, 0}, 7.8}});
  for (const int pieces : {1, 7}) {
    const RayIntegral sum = ray_integral(distance_ray(1.5, pieces), medium);
    EXPECT_NEAR(sum.optical_depth, 0.3 * 1.5 + 5 * 1.5 * 1.5 / 2, 1e-13);
  }
}

TEST(RayIntegral, OfLinearColourUnderConstantExtinction) {
  for (const double k : {1e-3, 0.8, 25.0, 1e5}) {
    const double c0 = 0.2, c1 = 0.6, l = 1.3;
    const Medium medium = Medium::of_rates(0, l, {{{c0 * k, 0, 0}, k}, {{(c0 + c1 * l) * k, 0, 0}, k}});
    const double exact = -c0 * std::expm1(-k * l) + c1 / k * (-std::expm1(-k * l) - k * l * std::exp(-k * l));
    EXPECT_NEAR(ray_integral(distance_ray(l, 3), medium).colour[0], exact, 1e-12) << k;
  }
}

TEST(RayIntegral, GlowsWithoutExtinction) {
  const Medium medium = Medium::of_rates(0, 1, {{{0.25, 0.5, 4}, 0}});
  const RayIntegral sum = ray_integral(ramp(0, 1, 3), medium);
  EXPECT_NEAR(sum.colour[2], 12, 1e-12);
  EXPECT_EQ(sum.optical_depth, 0);
}

TEST(RayIntegral, ShowsTheFirstOfTwoOpaqueLayers) {
  TransferFunction function;  // opaque red up to 0.25, clear, opaque blue from 0.75
  function.entries = {{1, 0, 0, 1}, {1, 0, 0, 1}, {0, 0, 0, 0}, {0, 0, 1, 1}, {0, 0, 1, 1}};
  const Medium medium = Medium::of_samples(function, 0.01);
  const RayIntegral forwards = ray_integral(ramp(0.1, 1, 1), medium);
  EXPECT_EQ(forwards.colour, (std::array<double, 3>{1, 0, 0}));
  EXPECT_EQ(forwards.optical_depth, infinite);
  const RayIntegral backwards = ray_integral(ramp(0.9, 0, 1), medium);
  EXPECT_EQ(backwards.colour, (std::array<double, 3>{0, 0, 1}));
}

TEST(RayIntegral, OfALayerIsTheLayersSample) {
  // A homogeneous path as long as the sample distance has exactly the opacity of one sample.
  for (const float opacity : {1e-9F, 1e-4F, 0.3F, 0.999F, 0.99999994F}) {
    TransferFunction function;
    function.entries = {{0.5F * opacity, 0, opacity, opacity}, {0.5F * opacity, 0, opacity, opacity}};
    const RayIntegral sum = ray_integral(ramp(0.2, 0.2, 0.03), Medium::of_samples(function, 0.03));
    EXPECT_NEAR(sum.opacity() / double(opacity), 1, 1e-12) << opacity;
    EXPECT_NEAR(sum.colour[0] / double(0.5F * opacity), 1, 1e-12) << opacity;
  }
}

TEST(RayIntegral, OfOpacityThatRisesToOne) {
  // extinction = -log(1 - t) over [0, 1]: the optical depth is 1, although the extinction is infinite at the
  // end.
  TransferFunction function;
  function.entries = {{0, 0, 0, 0}, {0, 0, 0, 1}};
  EXPECT_NEAR(ray_integral(ramp(0, 1, 1), Medium::of_samples(function, 1)).optical_depth, 1, 1e-12);
  EXPECT_NEAR(ray_integral(ramp(1, 0, 1), Medium::of_samples(function, 1)).optical_depth, 1, 1e-12);
}

TEST(RayIntegral, OfLayersThatAreAlmostOpaque) {
  // The last bit of such an opacity is a large part of its transparency: bisection must stop at equal values.
  TransferFunction function;
  function.entries.assign(256, {0, 0, 0, 0});
  for (std::size_t i = 158; i < 169; ++i) function.entries[i] = {0.5F, 0, 0, 0.9999F};
  const auto wave = [](double x) { return std::sin(8 * std::numbers::pi * x); };
  const Texture texture = sampled(describe({48, 48, 48}, TexelType::f32), [&](const Vec3& t) {
    return 0.5 + (wave(t[0]) * wave(t[1] + 0.0625) + wave(t[1]) * wave(t[2] + 0.0625) +
                  wave(t[2]) * wave(t[0] + 0.0625)) /
                     3;
  });
  const Field field = texture_field(texture.description, Filter::linear, texture.texels);
  for (const double y : {0.13, 0.37, 0.52, 0.88}) {
    const auto ray = field_along_ray(field, texture.description.size, {0, y, 0.05}, {1, 1 - y, 0.9}, 60);
    const RayIntegral sum = ray_integral(ray, Medium::of_samples(function, 1));
    EXPECT_NEAR(sum.opacity(), 1, 1e-2);
    EXPECT_NEAR(sum.colour[0], 0.5, 1e-2);
  }
}

TEST(RayIntegral, KeepsThinFog) {
  TransferFunction function;
  function.entries = {{0, 0, 0, 3e-8F}, {0, 0, 0, 3e-8F}};
  const RayIntegral sum = ray_integral(distance_ray(1e6, 1000), Medium::of_samples(function, 1));
  EXPECT_NEAR(sum.opacity(), -std::expm1(1e6 * std::log1p(-double(3e-8F))), 1e-13);
}

TEST(RayIntegral, FindsASpikeThinnerThanAnySample) {
  // A spike of width 1e-6 in value and optical depth 1: the ray crosses it within a millionth of its length.
  std::vector<Rate> entries(1'000'001);
  entries[500'000] = {{2e6, 0, 0}, 1e6};
  const RayIntegral sum = ray_integral(ramp(0, 1, 1), Medium::of_rates(0, 1, entries));
  EXPECT_NEAR(sum.optical_depth, 1, 1e-9);
  EXPECT_NEAR(sum.colour[0], 2 * -std::expm1(-1), 1e-9);
}

TEST(RayIntegral, DoesNotDependOnHowTheRayIsCut) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> value(0, 1);
  for (int round = 0; round < 20; ++round) {
    std::vector<Rate> entries(9);
    for (Rate& entry : entries) {
      const double k = std::pow(10, 6 * value(random) - 2);
      entry = {{k * value(random), k * value(random), k * value(random)}, k};
    }
    const Medium medium = Medium::of_rates(0, 1, entries);
    Stretch whole;
    whole.length = 1;
    whole.value[0] = cubic_through({value(random), value(random), value(random), value(random)});
    const double cut = value(random);
    std::array<Stretch, 2> parts;
    for (int i = 0; i < 2; ++i) {
      const double begin = i == 0 ? 0 : cut, end = i == 0 ? cut : 1;
      parts[i].length = end - begin;
      std::array<double, 4> v;
      for (int p = 0; p < 4; ++p) v[p] = whole.value[0](begin + (end - begin) * p / 3);
      parts[i].value[0] = cubic_through(v);
    }
    const RayIntegral a = ray_integral(std::span(&whole, 1), medium), b = ray_integral(parts, medium);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(a.colour[k], b.colour[k], 1e-11) << round;
    EXPECT_NEAR(a.opacity(), b.opacity(), 1e-12) << round;
    EXPECT_LT(a.error, 1e-10);
  }
}

TEST(RayIntegral, IsWhereSumsOfEverFinerSlicesLead) {
  // The viewer's own sum over more and more planes, with opacities for thinner and thinner layers, converges to
  // the integral with order 1 or better. Both take the field from the same texture.
  const Texture texture = sampled(describe({13, 11, 9}, TexelType::f32), marschner_lobb_field());
  const Field field = texture_field(texture.description, Filter::linear, texture.texels);
  TransferFunction function;
  function.entries = {{0, 0, 0, 0}, {0.3F, 0.1F, 0, 0.4F}, {0, 0, 0.1F, 0.1F}, {0.2F, 0.6F, 0.3F, 0.9F}};
  const double distance = 0.1;
  const Vec3 from{0.31, 0.77, 0}, to{0.31, 0.77, 1};
  const RayIntegral exact = ray_integral(field_along_ray(field, texture.description.size, from, to, 1),
                                         Medium::of_samples(function, distance));
  double last = 1;
  for (const int n : {100, 1000, 10000}) {
    double depth = 0;
    std::array<double, 3> colour{};
    const Medium medium = Medium::of_samples(function, distance);
    for (int i = 0; i < n; ++i) {
      const double value = field({0.31, 0.77, (i + 0.5) / n})[0];
      const Rate rate = medium.rate(medium.segment_of(value), value);
      const double seen = rate.extinction > 0 ? -std::expm1(-rate.extinction / n) / rate.extinction : 1.0 / n;
      for (int k = 0; k < 3; ++k) colour[k] += std::exp(-depth) * rate.source[k] * seen;
      depth += rate.extinction / n;
    }
    double error = std::abs(std::exp(-depth) - std::exp(-exact.optical_depth));
    for (int k = 0; k < 3; ++k) error = std::max(error, std::abs(colour[k] - exact.colour[k]));
    std::printf("%d samples: %.2e\n", n, error);
    EXPECT_LT(error, 0.3 * last);
    last = error;
  }
  EXPECT_LT(last, 1e-6);
}

TEST(RayIntegral, OfColoursInTheTexels) {
  Stretch stretch;
  stretch.length = 0.5;
  stretch.value = {Cubic{{0.2, 0, 0, 0}}, Cubic{{0.4, 0, 0, 0}}, Cubic{{0.6, 0, 0, 0}}, Cubic{{0.3, 0, 0, 0}}};
  const RayIntegral sum = ray_integral(std::span(&stretch, 1), LinearMap{}, 0.1);
  EXPECT_NEAR(sum.opacity(), 1 - std::pow(0.7, 5), 1e-13);
  EXPECT_NEAR(sum.colour[1], 0.4 * (1 - std::pow(0.7, 5)), 1e-13);
  stretch.value[3] = Cubic{{1, 0, 0, 0}};
  EXPECT_EQ(ray_integral(std::span(&stretch, 1), LinearMap{}, 0.1).optical_depth, infinite);
}

TEST(RayExtreme, SeesAPeakBetweenSamplesAndInsideTheTable) {
  TransferFunction function;
  function.entries = {{0, 0, 0, 0}, {0.1F, 0.9F, 0, 0.3F}, {0, 0, 0, 0.2F}};
  const Medium medium = Medium::of_samples(function, 1);
  const auto greatest = ray_extreme(ramp(0, 0.9, 1), medium, true);
  ASSERT_TRUE(greatest);
  EXPECT_NEAR((*greatest)[1], double(0.9F), 1e-14) << "the entry at 0.5 lies between all samples";
  EXPECT_NEAR((*ray_extreme(ramp(0.1, 0.9, 1), medium, false))[1], double(0.9F) * 0.2, 1e-14);
  EXPECT_FALSE(ray_extreme({}, medium, true));
}

TEST(RaySum, IsTheAreaUnderTheEntries) {
  TransferFunction function;
  function.entries = {{0, 0, 0, 0}, {0, 0, 0, 0.5F}, {0, 0, 0, 0}};
  EXPECT_NEAR(ray_sum(ramp(0, 1, 4), Medium::of_samples(function, 1))[3], 1, 1e-14);
}

TEST(FirstHit, OfARampInATexture) {
  const Texture texture = sampled(describe({5, 5, 33}, TexelType::f32), [](const Vec3& t) { return t[2]; });
  const Field field = texture_field(texture.description, Filter::linear, texture.texels);
  const auto ray = field_along_ray(field, texture.description.size, {0.1, 0.9, 0}, {0.9, 0.2, 1}, 10);
  const auto hit = first_hit(ray, 0.625);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(*hit, 6.25, 1e-5) << "texels are floats";
  EXPECT_FALSE(first_hit(ray, 1.5));
}

TEST(Crossings, OfACubicAreAllOfItsRoots) {
  // (u - 0.1)(u - 0.5)(u - 0.8)
  const Cubic cubic{{-0.04, 0.53, -1.4, 1}};
  const auto found = crossings(cubic, 0);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_NEAR(found[0], 0.1, 1e-14);
  EXPECT_NEAR(found[1], 0.5, 1e-14);
  EXPECT_NEAR(found[2], 0.8, 1e-14);
  EXPECT_TRUE(crossings(cubic, 10).empty());
}

TEST(Media, RefuseTablesThatMeanNothing) {
  EXPECT_THROW(Medium::of_rates(0, 1, {}), std::invalid_argument);
  EXPECT_THROW(Medium::of_rates(0, 1, {{{0, 0, 0}, -1}}), std::invalid_argument);
  EXPECT_THROW(Medium::of_rates(1, 0, {{{0, 0, 0}, 1}, {{0, 0, 0}, 1}}), std::invalid_argument);
  TransferFunction function;
  function.entries = {{0, 0, 0, 1.5F}, {0, 0, 0, 0}};
  EXPECT_THROW(Medium::of_samples(function, 1), std::invalid_argument);
  function.entries = {{0, 0, 0, std::numeric_limits<float>::quiet_NaN()}, {0, 0, 0, 0}};
  EXPECT_THROW(Medium::of_samples(function, 1), std::invalid_argument);
  function.entries = {{0, 0, 0, 0.5F}, {0, 0, 0, 0}};
  EXPECT_THROW(Medium::of_samples(function, 0), std::invalid_argument);
}

}  // namespace
}  // namespace understudy::volume::testing
