// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/verification/sentinels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace understudy::spu {
namespace {

TEST(Sentinels, LieOnPixelsOfTheEdgesAsOftenAsOnOthers) {
  constexpr int edge = 48;
  constexpr int tiles = 20000;
  const volume::Rect window{10, 20, edge, edge};
  Sentinels sentinels;
  std::vector<int> hits(edge);  // of the diagonal's pixels, without rims
  for (int i = 0; i < tiles; ++i) {
    const volume::Rect tile = sentinels.next_tile(window);
    EXPECT_EQ(intersection(tile, window), tile);
    for (int k = 0; k < edge; ++k) {
      const int x = window.x + k;
      const int y = window.y + k;
      hits[std::size_t(k)] +=
          x >= tile.x && x < tile.x + tile.width && y >= tile.y && y < tile.y + tile.height ? 1 : 0;
    }
  }
  const int middle = hits[edge / 2];
  EXPECT_GT(middle, 0);
  for (const int pixel : hits) EXPECT_GT(pixel, 0.75 * middle);
}

TEST(Sentinels, FitIntoWindowsSmallerThanATile) {
  const volume::Rect window{3, 4, 5, 1};
  Sentinels sentinels;
  for (int i = 0; i < 100; ++i) EXPECT_EQ(sentinels.next_tile(window), window);
}

}  // namespace
}  // namespace understudy::spu
