// SPDX-License-Identifier: Apache-2.0
// Certified error bounds: in random scenes, from smooth to stiff, no pixel differs from the integral by more
// than its bound.
#include "volume/error_bound/error_bound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/volume/parts.h"
#include "volume/opacity_correction.h"
#include "volume/orbit_camera.h"
#include "volume/raycast/segment_scene.h"
#include "volume/reference/pixel_integral.h"

namespace understudy::volume::testing {
namespace {

using Random = std::mt19937;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

template <typename Choice>
Choice one_of(Random& random, std::initializer_list<Choice> choices) {
  return choices.begin()[random() % choices.size()];
}

Texture random_texture(Random& random) {
  const auto type = one_of(random, {TexelType::u8, TexelType::u16, TexelType::f32});
  const auto size = [&] { return int(8 + random() % 14); };
  const VolumeDescription description = describe({size(), size(), size()}, type);
  switch (random() % 4) {
    case 0:
      return noise(description, unsigned(random()));
    case 1:
      return sampled(description, marschner_lobb_field());
    case 2:
      return sampled(description, sphere_field(uniform(random, 0.2, 0.45), uniform(random, 0.02, 0.3)));
    default:
      return sampled(description,
                     linear_field({uniform(random, -0.4, 0.4), uniform(random, -0.3, 0.3), 0.2}, 0.5));
  }
}

/// Opacity and colour for one voxel: smooth, a box, a comb, or a single spike among up to 4,096 entries.
TransferFunction random_table(Random& random) {
  TransferFunction table;
  const auto entries = one_of<std::size_t>(random, {2, 16, 256, 4096});
  const double opacity = one_of(random, {0.01, 0.1, 0.5, 0.95, 0.9999});
  const auto kind = random() % 4;
  const double from = uniform(random, 0.1, 0.7), wide = uniform(random, 0.02, 0.3);
  const auto spike = std::size_t(uniform(random, 0.2, 0.8) * double(entries));
  const std::array<double, 3> low{uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1)};
  const std::array<double, 3> high{uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1)};
  for (std::size_t i = 0; i < entries; ++i) {
    const double v = double(i) / double(entries - 1);
    double alpha = 0;
    if (kind == 0) alpha = opacity * (0.5 + 0.5 * std::sin(9 * v));
    if (kind == 1) alpha = v > from && v < from + wide ? opacity : 0;
    if (kind == 2) alpha = i % 2 == 0 ? opacity : 0;
    if (kind == 3) alpha = i == spike ? opacity : 0;
    Rgba& entry = table.entries.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) entry[k] = float(alpha * std::lerp(low[k], high[k], v));
    entry[3] = float(alpha);
  }
  return table;
}

RenderRequest bound_request(const Texture& texture, const TransferFunction& of_voxel, const OrbitCamera& camera,
                            double step) {
  RenderRequest request = orbit_request(texture.description, {1, 1, 1}, camera, 24, 20, step);
  request.classification = opacity_corrected(of_voxel, step, 4096);
  request.steps->cover_whole_ray = true;
  request.bound_of = {of_voxel, step};
  return request;
}

/// As many pixels are integrated because of their bounds.
constexpr std::size_t greatest_integrated = 20;

struct Outcome {
  double bound = 0;  ///< largest of the image
  double error = 0;  ///< largest of the integrated pixels
};

Outcome outcome_of(Texture texture, const TransferFunction& of_voxel, double step, const OrbitCamera& camera,
                   const std::string& scene) {
  RenderRequest request = bound_request(texture, of_voxel, camera, step);
  const RenderRequest unit = orbit_request(texture.description, {1, 1, 1}, camera, 24, 20, 1);

  texture.description.ghost_layer = ghost_layer_needed(texture.description, request);
  const BrickStore store = filled(texture);
  const std::vector<float> bounds = error_bounds(store, FieldVariation(store), request, 1);
  Image image(request.window);
  FrameCounts counts;
  request.bound_of.reset();
  raycast(store, request, image, counts);
  const Field field = texture_field(texture.description, Filter::linear, texture.texels);
  const Medium medium = Medium::of_samples(of_voxel, 1);
  // Pixels all over the image, and those where the bound is greatest: there the error may be, too.
  std::vector<float> sorted = bounds;
  std::ranges::sort(sorted, std::greater());
  const float among_greatest = sorted[greatest_integrated];
  Outcome outcome;
  outcome.bound = double(sorted.front());
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 24; ++x) {
      const float bound_of_pixel = bounds[std::size_t(24) * std::size_t(y) + std::size_t(x)];
      if ((x + 3 * y) % 11 != 0 && bound_of_pixel <= among_greatest) continue;
      const auto bound = double(bound_of_pixel);
      const auto exact = pixel_integral(field, texture.description.size, unit, medium, x, y);
      double error = 0;
      for (std::size_t k = 0; k < 4; ++k)
        error = std::max(error, std::abs(double(image.at(x, y)[k]) - exact[k]));
      // The reference's own error is at most a hundredth of a bound, or 1e-7.
      EXPECT_LE(error, bound + std::max(0.01 * bound, 1e-7)) << scene << ", pixel " << x << ", " << y;
      outcome.error = std::max(outcome.error, error);
    }
  return outcome;
}

Outcome outcome_of(unsigned seed) {
  Random random(seed);
  Texture texture = random_texture(random);
  const TransferFunction of_voxel = random_table(random);
  const double step = one_of(random, {0.125, 0.25, 0.5, 1.0, 2.0, 4.0});
  const OrbitCamera camera{uniform(random, -180, 180), uniform(random, -80, 80),
                           one_of(random, {0.4, 1.5, 3.0, 8.0})};
  return outcome_of(std::move(texture), of_voxel, step, camera, "scene " + std::to_string(seed));
}

TransferFunction uniform_table(float opacity) {
  return {0, 1, {{opacity, opacity, opacity, opacity}, {opacity, opacity, opacity, opacity}}};
}

void expect_certified(unsigned scenes) {
  std::vector<double> index;
  for (unsigned seed = 1; seed <= scenes; ++seed) {
    const Outcome outcome = outcome_of(seed);
    if (outcome.error >= 1e-5) index.push_back(outcome.bound / outcome.error);
  }
  ASSERT_GT(index.size(), scenes / 2);
  std::ranges::sort(index);
  const auto at = [&](double share) { return index[std::size_t(share * double(index.size() - 1))]; };
  std::printf(
      "%zu of %u scenes with an error of 1e-5 and more: bound over error %.2f in the median, 95 %% below "
      "%.1f\n",
      index.size(), scenes, at(0.5), at(0.95));
  EXPECT_LE(at(0.5), 4);
  EXPECT_LE(at(0.95), 20);
}

TEST(ErrorBound, HoldsInRandomScenes) {
  expect_certified(100);
}

TEST(FullErrorBound, HoldsInAThousandRandomScenes) {
  expect_certified(1000);
}

TEST(ErrorBound, HoldsBesideTexelsThatAreNotNumbers) {
  Texture texture = sampled(describe({17, 17, 17}, TexelType::f32), sphere_field(0.4, 0.2));
  constexpr std::size_t half = sizeof(float) * 17 * 17 * 9;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t at = half; at + sizeof nan <= texture.texels.size(); at += sizeof nan)
    std::memcpy(texture.texels.data() + at, &nan, sizeof nan);
  for (const float opacity : {0.1F, 1.0F})
    for (const double step : {0.5, 4.0}) {
      const Outcome outcome = outcome_of(texture, uniform_table(opacity), step, {20, 35, 3}, "beside NaN");
      std::printf("opacity %g, step %g: bound %.2e, error %.2e\n", double(opacity), step, outcome.bound,
                  outcome.error);
    }
}

/// Rays cross faces of cells across x and y at once, next to opaque values.
TEST(ErrorBound, HoldsAlongDiagonals) {
  const Texture texture = sampled(describe({17, 17, 17}, TexelType::u8), sphere_field(0.4, 0.2));
  TransferFunction table;
  for (int i = 0; i < 16; ++i) {
    const auto alpha = i < 6 ? 0.0F : i > 9 ? 1.0F : float(i - 5) / 5;
    table.entries.push_back({alpha, 0.5F * alpha, 0, alpha});
  }
  for (const OrbitCamera& camera : {OrbitCamera{-45, 0, 2}, OrbitCamera{135, 0, 2}, OrbitCamera{0, -45, 2}}) {
    const Outcome outcome = outcome_of(texture, table, 1, camera, "diagonal");
    EXPECT_LE(outcome.bound, 1.0001) << camera.azimuth;
    EXPECT_GT(outcome.error, 0);
  }
}

TEST(ErrorBound, IsForMediaThatHaveAPlainColour) {
  Texture texture = noise(describe({9, 9, 9}, TexelType::u8), 3);
  texture.description.ghost_layer = 8;
  const BrickStore store = filled(texture);
  TransferFunction emission = uniform_table(0.5F);
  emission.entries[0][3] = 0;
  const RenderRequest request = bound_request(texture, emission, {}, 1);
  EXPECT_THROW(error_bounds(store, FieldVariation(store), request, 1), std::invalid_argument);
}

TEST(ErrorBound, FallsWithTheStepWhereAllIsSmooth) {
  Texture texture = sampled(describe({33, 33, 33}, TexelType::f32), linear_field({0.3, 0.25, 0.35}, 0.05));
  texture.description.ghost_layer = 16;
  const BrickStore store = filled(texture);
  const FieldVariation variation(store);
  TransferFunction of_voxel;
  for (int i = 0; i < 1024; ++i) {
    const double v = i / 1023.0;
    const auto alpha = float(-std::expm1(-0.06 * v * v));
    of_voxel.entries.push_back({alpha, 0.5F * alpha, 0, alpha});
  }
  std::vector<double> bounds;
  for (const double step : {4.0, 2.0, 1.0, 0.5, 0.25}) {
    const RenderRequest request = bound_request(texture, of_voxel, {33, 21, 3}, step);
    const double bound = double(std::ranges::max(error_bounds(store, variation, request, 1)));
    std::printf("step %g: bound %.2e\n", step, bound);
    // Bounds follow errors, which fall with the square of the step, but not evenly.
    if (!bounds.empty()) {
      EXPECT_LT(bound, bounds.back()) << step;
    }
    bounds.push_back(bound);
  }
  EXPECT_LT(bounds.back(), bounds.front() / 15);
  EXPECT_LT(bounds.back(), 6e-5);
}

TEST(ErrorBound, OfPartsComposesToABoundOfTheWhole) {
  const auto draw = [](const BrickStore& store, const RenderRequest& request, Image& image,
                       FrameCounts& counts) { ErrorBoundRenderer(store).render(request, image, counts); };
  Texture texture = noise(describe({23, 31, 27}, TexelType::u8), 9);
  texture.description.ghost_layer = 8;
  for (const double step : {0.5, 2.0}) {
    RenderRequest request = bound_request(texture, smooth_table(), {33, 21, 3}, step);
    const Whole whole = render_whole(texture, request, draw);
    const BrickStore store = filled(texture);
    EXPECT_EQ(error_bounds(store, FieldVariation(store), request, 1)[24 * 10 + 12],
              std::min(whole.image.at(12, 10)[0], std::nextafter(1.0F, 2.0F)))
        << "no two images differ by more than 1";
    for (const int ranks : {2, 5}) {
      const Image parts = render_parts(texture, request, ranks, draw).image;
      float of_parts = 0, of_whole = 0;
      for (std::size_t i = 0; i < parts.rgba.size(); i += 4) {
        // Errors of different parts do not cancel, and each part is divided as finely as its own error
        // requires.
        ASSERT_GE(parts.rgba[i], 0.5F * whole.image.rgba[i] - 1e-5F) << i;
        of_parts = std::max(of_parts, parts.rgba[i]);
        of_whole = std::max(of_whole, whole.image.rgba[i]);
        ASSERT_NEAR(parts.rgba[i + 3], whole.image.rgba[i + 3], 0.05F) << i;
      }
      std::printf("step %g, %d ranks: bound %.2e, of the whole %.2e\n", step, ranks, double(of_parts),
                  double(of_whole));
      EXPECT_LE(of_parts, 3 * of_whole);
    }
    request.bound_of.reset();
    const Image image = render_whole(texture, request).image;
    for (std::size_t i = 3; i < image.rgba.size(); i += 4)
      ASSERT_LE(whole.image.rgba[i], image.rgba[i] + whole.image.rgba[i - 1] + 1e-5F)
          << "the least opacity, of the integral";
  }
}

TEST(ErrorBound, IsForSamplesThatCoverWholeRaysInAVolumeWithAGhostLayer) {
  Texture texture = noise(describe({9, 9, 9}, TexelType::u8), 3);
  texture.description.ghost_layer = 8;
  const BrickStore store = filled(texture);
  const FieldVariation variation(store);
  const RenderRequest good = bound_request(texture, smooth_table(), {}, 1);
  EXPECT_EQ(error_bounds(store, variation, good, 4).size(), 6U * 5U);
  RenderRequest bad = good;
  bad.steps->cover_whole_ray = false;
  EXPECT_THROW(error_bounds(store, variation, bad, 1), std::invalid_argument);
  bad = good;
  bad.bound_of.reset();
  EXPECT_THROW(error_bounds(store, variation, bad, 1), std::invalid_argument);
  Texture bordered = noise(describe({9, 9, 9}, TexelType::u8, Wrap::border), 3);
  bordered.description.ghost_layer = 8;
  EXPECT_THROW(error_bounds(filled(bordered), variation, good, 1), std::invalid_argument);
  texture.description.ghost_layer = 1;
  EXPECT_THROW(error_bounds(filled(texture), variation, good, 1), std::invalid_argument);
}

}  // namespace
}  // namespace understudy::volume::testing
