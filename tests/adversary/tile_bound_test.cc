// SPDX-License-Identifier: Apache-2.0
// What the bound passes, and what it does not.
#include "tests/adversary/tile_bound.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace adversary {
namespace {

constexpr int edge = 64;

Image even(std::uint8_t value, int width = edge, int height = edge) {
  return {width, height, std::vector<std::uint8_t>(std::size_t{4} * width * height, value)};
}

/// Adds `by` to the green channel of a rectangle's pixels.
Image changed(Image image, int x, int y, int width, int height, int by) {
  for (int j = y; j < y + height; ++j)
    for (int i = x; i < x + width; ++i) {
      std::uint8_t& green = image.rgba[4 * (static_cast<std::size_t>(j) * image.width + i) + 1];
      green = static_cast<std::uint8_t>(green + by);
    }
  return image;
}

TEST(TileBound, PassesAnythingBetweenTheTwoBareImages) {
  EXPECT_EQ(worst_tile(even(120), even(100), even(130)).excess, 0);
  EXPECT_EQ(worst_tile(even(120), even(130), even(100)).excess, 0);
}

TEST(TileBound, CountsWhatLiesOutside) {
  EXPECT_EQ(worst_tile(even(90), even(100), even(130)).excess, 10);
  EXPECT_EQ(worst_tile(even(137), even(100), even(130)).excess, 7);
}

TEST(TileBound, FindsOneWrongTileAndSaysWhere) {
  const Image right = even(100);
  const TileScore tile = worst_tile(changed(right, 32, 48, 16, 16, 20), right, right);
  EXPECT_EQ(tile.excess, 20);
  EXPECT_EQ(tile.x, 32);
  EXPECT_EQ(tile.y, 48);
}

TEST(TileBound, PassesALineOfPixelsAlongASilhouette) {
  const Image right = even(100);
  EXPECT_EQ(worst_tile(changed(right, 16, 0, 2, edge, 90), right, right).excess, 0);
  EXPECT_EQ(worst_tile(changed(right, 16, 0, 3, edge, 90), right, right).excess, 90);
}

TEST(TileBound, JudgesTheNarrowTilesAtTheEdges) {
  const Image right = even(100, 67, 64);
  const TileScore tile = worst_tile(changed(right, 64, 16, 3, 16, 20), right, right);
  EXPECT_EQ(tile.excess, 20);
  EXPECT_EQ(tile.x, 64);
}

TEST(TileBound, RefusesImagesOfAnotherSize) {
  EXPECT_THROW(worst_tile(even(1), even(1, 32, 32), even(1)), std::runtime_error);
}

}  // namespace
}  // namespace adversary
