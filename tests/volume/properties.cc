// SPDX-License-Identifier: Apache-2.0
#include "tests/volume/properties.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <exception>

#include "tests/volume/random_scenes.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::volume::testing {

namespace {

struct Worst {
  double partition = 0, mirror = 0, colour = 0;
  int refused = 0, shown = 0, lopsided = 0;
};

Image mirrored(const Image& image) {
  Image result(image.rect);
  for (int y = 0; y < image.rect.height; ++y)
    for (int x = 0; x < image.rect.width; ++x)
      for (int k = 0; k < 4; ++k)
        result.at(image.rect.x + x, image.rect.y + y)[k] =
            image.at(image.rect.x + image.rect.width - 1 - x, image.rect.y + y)[k];
  return result;
}

/// By how much the image's colour exceeds the brightest colour of the transfer function.
double colour_excess(const RandomScene& scene, const Image& image) {
  std::array<double, 3> brightest{1, 1, 1};
  if (const auto* table = std::get_if<TransferFunction>(&scene.request.classification)) {
    brightest = {};
    for (const Rgba& entry : table->entries)
      for (std::size_t k = 0; k < 3; ++k)
        if (entry[3] > 0) brightest[k] = std::max(brightest[k], double(entry[k]) / double(entry[3]));
  }
  double excess = 0;
  for (std::size_t p = 0; p < image.rgba.size(); p += 4)
    for (std::size_t k = 0; k < 3; ++k)
      excess = std::max(excess, double(image.rgba[p + k]) - double(image.rgba[p + 3]) * brightest[k]);
  return excess;
}

void expect_of(const RandomScene& scene, int ranks, const PropertyTrials& asked, const DrawBricks& draw,
               Worst& worst) {
  const RenderRequest& request = scene.request;
  const Image image = render_whole(scene.texture, request, draw).image;
  double largest = 0;
  for (const float v : image.rgba) {
    ASSERT_TRUE(std::isfinite(v));
    // Without a sample, a minimum is the largest float.
    if (v < 1e30F) largest = std::max(largest, double(std::abs(v)));
  }
  worst.shown += largest > 0 ? 1 : 0;
  // The error of sums grows with their size.
  const double unit = std::max(1.0, largest);

  const Image parts = render_parts(scene.texture, request, ranks, draw).image;
  const double apart = difference(image, parts).max / unit;
  worst.partition = std::max(worst.partition, apart);
  EXPECT_LE(apart, asked.apart) << ranks << " ranks";

  // For wild texels or nearest filtering, the last bit of a position decides which value is sampled.
  if (!scene.wild_texels && request.filter == Filter::linear) {
    RenderRequest other = request;
    for (std::size_t k = 0; k < 4; ++k) other.texture_to_clip[k] = -other.texture_to_clip[k];
    const double d = difference(mirrored(render_whole(scene.texture, other, draw).image), image).max / unit;
    worst.mirror = std::max(worst.mirror, d / (1 + scene.steepness));
    worst.lopsided += difference(mirrored(image), image).max > 1e-2 ? 1 : 0;
    EXPECT_LE(d, asked.apart * (1 + scene.steepness));
  }

  if (request.op != Operator::over) return;
  for (std::size_t p = 3; p < image.rgba.size(); p += 4) {
    ASSERT_GE(image.rgba[p], 0);
    ASSERT_LE(image.rgba[p], 1);
  }
  if (!scene.coloured_medium) return;
  const double excess = colour_excess(scene, image);
  worst.colour = std::max(worst.colour, excess);
  EXPECT_LE(excess, 2e-6);
}

}  // namespace

void expect_properties(const PropertyTrials& asked, const DrawBricks& draw) {
  const unsigned seed = test_seed();
  std::mt19937 random(seed);
  Worst worst;
  for (int trial = 0; trial < asked.trials; ++trial) {
    const RandomScene scene = random_scene(random);
    const int ranks = std::uniform_int_distribution<int>(2, 9)(random);
    SCOPED_TRACE("UNDERSTUDY_TEST_SEED=" + std::to_string(seed) + ", trial " + std::to_string(trial) + ": " +
                 scene.text);
    try {
      expect_of(scene, ranks, asked, draw, worst);
    } catch (const std::exception& refusal) {
      EXPECT_TRUE(asked.may_refuse && (scene.wild_texels || scene.request.method != Method::post_classified))
          << refusal.what();
      ++worst.refused;
    }
  }
  std::printf(
      "%s, %d scenes from seed %u, %d of them not clear, %d refused: 2 to 9 ranks from one %.1e, mirrored "
      "%.1e for each unit of steepness, colour above the medium's %.1e\n",
      asked.renderer, asked.trials, seed, worst.shown, worst.refused, worst.partition, worst.mirror,
      worst.colour);
  EXPECT_GT(worst.shown, asked.trials / 2) << "empty images test nothing";
  EXPECT_GT(worst.lopsided, asked.trials / 4) << "nor do those that are their own mirror images";
}

}  // namespace understudy::volume::testing
