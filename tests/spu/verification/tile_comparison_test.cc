// SPDX-License-Identifier: Apache-2.0
// The bound that every tile of an image must keep: correct images pass, one wrong tile fails.
#include "spu/volume/verification/tile_comparison.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "volume/image.h"

namespace understudy::spu {
namespace {

constexpr int edge = 128;

/// Rings of colour on black, like a volume in the middle of a window.
volume::Image rings(double phase = 0, double radius = 44) {
  volume::Image image({0, 0, edge, edge});
  for (int y = 0; y < edge; ++y) {
    for (int x = 0; x < edge; ++x) {
      const double r = std::hypot(x - 64, y - 64);
      const double alpha = r < radius ? 0.8 : 0;
      const double wave = 0.5 + 0.5 * std::sin(0.4 * r + phase);
      const std::array<float, 4> colour{float(alpha * wave), float(alpha * (1 - wave)), float(alpha * 0.3),
                                        float(alpha)};
      std::copy(colour.begin(), colour.end(), image.at(x, y));
    }
  }
  return image;
}

NativeImage native(const volume::Image& image) {
  return {image.rect, image.rgba};
}

ImageDifference between(const volume::Image& theirs, const volume::Image& ours) {
  return difference_between(Pipeline{}, native(theirs), ours.view());
}

TEST(TileComparison, EqualImagesDifferNowhere) {
  const ImageDifference difference = between(rings(), rings());
  EXPECT_EQ(difference.worst.excess, 0);
  EXPECT_EQ(difference.max, 0);
  EXPECT_TRUE(difference.anything_visible);
}

TEST(TileComparison, BlackImagesShowNothing) {
  const volume::Image black({0, 0, edge, edge});
  EXPECT_FALSE(between(black, black).anything_visible);
}

TEST(TileComparison, OneWrongTileFailsWhereverItIs) {
  const volume::Image theirs = rings();
  for (int tile = 0; tile < edge * edge / 256; ++tile) {
    const int x0 = tile % 8 * 16, y0 = tile / 8 * 16;
    volume::Image ours = rings();
    for (int y = y0; y < y0 + 16; ++y) {
      for (int x = x0; x < x0 + 16; ++x) {
        for (int c = 0; c < 3; ++c) ours.at(x, y)[c] = ours.at(x, y)[c] > 0.1F ? 0.0F : 0.4F;
      }
    }
    const ImageDifference difference = between(theirs, ours);
    ASSERT_FALSE(difference.worst.within_bound()) << "tile at " << x0 << ", " << y0;
    EXPECT_EQ(difference.worst.tile.x, x0);
    EXPECT_EQ(difference.worst.tile.y, y0);
    EXPECT_GT(difference.psnr(), 18) << "an average over the image hides it";
  }
}

TEST(TileComparison, ASilhouetteThatIsOffByAPixelPasses) {
  EXPECT_TRUE(between(rings(), rings(0, 45)).worst.within_bound());
}

TEST(TileComparison, RoundingToEightBitsAfterEverySlicePasses) {
  volume::Image ours = rings();
  std::mt19937 random(7);
  std::uniform_real_distribution<float> rounding(-4.0F / 255, 4.0F / 255);
  for (float& value : ours.rgba) value = value > 0 ? value + rounding(random) : value;
  EXPECT_TRUE(between(rings(), ours).worst.within_bound());
}

TEST(TileComparison, AnotherPatternOfColoursThatChangeFromPixelToPixelFails) {
  volume::Image theirs = rings(), ours = rings();
  for (int y = 0; y < edge; ++y) {
    for (int x = 0; x < edge; ++x) {
      theirs.at(x, y)[0] = (x + y) % 2 == 0 ? 0.4F : 0.5F;
      ours.at(x, y)[0] = (x + y) % 2 == 0 ? 0.5F : 0.4F;
    }
  }
  const ImageDifference difference = between(theirs, ours);
  EXPECT_EQ(difference.worst.excess, 0) << "each has a neighbour of its colour";
  EXPECT_FALSE(difference.worst.within_bound());
}

TEST(TileComparison, AnotherPhaseOfTheRingsFails) {
  EXPECT_FALSE(between(rings(), rings(1)).worst.within_bound());
}

TEST(TileComparison, AnEverywhereDarkerImageFails) {
  volume::Image ours = rings();
  for (float& value : ours.rgba) value *= 0.8F;
  EXPECT_FALSE(between(rings(), ours).worst.within_bound());
}

TEST(TileComparison, WhatTheOtherImageHasOutsideOfOursCounts) {
  volume::Image theirs = rings();
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) theirs.at(x, y)[0] = 0.5F;
  }
  const volume::Image all = rings();
  volume::Image ours({20, 20, 88, 88});
  for (int y = 20; y < 108; ++y) std::copy(all.at(20, y), all.at(107, y) + 4, ours.at(20, y));
  const ImageDifference difference = between(theirs, ours);
  EXPECT_FALSE(difference.worst.within_bound());
  EXPECT_EQ(difference.worst.tile.x, 0);
}

TEST(TileComparison, ValuesThatAreNoNumbersAreShownAsNothing) {
  volume::Image ours = rings();
  for (int y = 60; y < 76; ++y) {
    for (int x = 60; x < 76; ++x) ours.at(x, y)[1] = std::numeric_limits<float>::quiet_NaN();
  }
  const ImageDifference difference = between(rings(), ours);
  EXPECT_TRUE(std::isfinite(difference.worst.excess));
  EXPECT_FALSE(difference.worst.within_bound());
}

TEST(TileComparison, ALargeFloatFramebufferIsMeasuredByItsBrightestColour) {
  Pipeline pipeline;
  pipeline.target.floating = true;
  volume::Image theirs = rings(), ours = rings();
  for (float& value : theirs.rgba) value *= 100;
  for (float& value : ours.rgba) value *= 100.2F;
  EXPECT_TRUE(difference_between(pipeline, native(theirs), ours.view()).worst.within_bound());
}

}  // namespace
}  // namespace understudy::spu
