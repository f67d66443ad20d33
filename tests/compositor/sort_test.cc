// SPDX-License-Identifier: Apache-2.0
#include "compositor/sort/sort.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "compositor/sort/cost_image.h"
#include "compositor/sort/image_leaves.h"

namespace understudy::compositor {
namespace {

using volume::Rect;

/// `count` machines with equally many ranks, which MPI has assigned to them in turn.
std::vector<int> spread_over(int count, int ranks) {
  std::vector<int> machines;
  machines.reserve(std::size_t(ranks));
  for (int rank = 0; rank < ranks; ++rank) machines.push_back(rank % count);
  return machines;
}

std::vector<int> on_one_machine(int ranks) {
  return std::vector<int>(std::size_t(ranks));
}

TEST(Arrangement, OfSortLastHasOneGroupWhoseMembersKeepTheirOwnBricks) {
  for (int ranks = 1; ranks <= 20; ++ranks)
    for (const int machines : {1, 2, ranks}) {
      const Arrangement arrangement({Sort::last}, spread_over(machines, ranks), 1000);
      EXPECT_EQ(arrangement.members(), ranks);
      EXPECT_EQ(arrangement.groups(), 1);
      for (int rank = 0; rank < ranks; ++rank) {
        EXPECT_EQ(arrangement.place(rank).keeper, rank);
        EXPECT_EQ(arrangement.readers(rank), 1);
      }
    }
}

TEST(Arrangement, OfSortFirstKeepsACopyOnEachMachine) {
  for (const int machines : {1, 2, 4}) {
    const Arrangement arrangement({Sort::first, 0, 1000}, spread_over(machines, 8), 1000);
    EXPECT_EQ(arrangement.members(), 1);
    EXPECT_EQ(arrangement.groups(), 8);
    for (int rank = 0; rank < 8; ++rank) {
      EXPECT_EQ(arrangement.place(rank).keeper, rank % machines);
      EXPECT_EQ(arrangement.readers(rank), rank < machines ? 8 / machines : 0);
    }
  }
}

TEST(Arrangement, KeepsSmallVolumesOnEveryRank) {
  const Arrangement arrangement({Sort::first, 0, 1000}, on_one_machine(4), 999);
  for (int rank = 0; rank < 4; ++rank) EXPECT_EQ(arrangement.readers(rank), 1);
}

TEST(Arrangement, OfHybridHasAboutAsManyGroupsAsMembers) {
  EXPECT_EQ(Arrangement({Sort::hybrid}, on_one_machine(16), 1000).members(), 4);
  EXPECT_EQ(Arrangement({Sort::hybrid}, on_one_machine(8), 1000).members(), 4);
  EXPECT_EQ(Arrangement({Sort::hybrid}, on_one_machine(7), 1000).members(), 7);
  // Among machines, whose ranks divide an image further.
  const Arrangement machines({Sort::hybrid}, spread_over(4, 16), 1000);
  EXPECT_EQ(machines.members(), 2);
  EXPECT_EQ(machines.groups(), 8);
}

TEST(Arrangement, AutomaticallyAsFewMachinesHoldACopyAsHaveRoomForIt) {
  const SortSettings settings{Sort::automatic, 300};
  EXPECT_EQ(Arrangement(settings, spread_over(8, 8), 300).members(), 1);
  EXPECT_EQ(Arrangement(settings, spread_over(8, 8), 600).members(), 2);
  EXPECT_EQ(Arrangement(settings, spread_over(8, 16), 1000).members(), 4);
  EXPECT_EQ(Arrangement(settings, spread_over(6, 6), 1000).members(), 6);  // four does not divide six
  EXPECT_EQ(Arrangement(settings, spread_over(8, 8), 100'000).members(), 8);
  // If machines have different numbers of ranks, each rank has room for the whole volume, or all divide it.
  EXPECT_EQ(Arrangement(settings, {0, 0, 0, 1}, 300).members(), 1);
  EXPECT_EQ(Arrangement(settings, {0, 0, 0, 1}, 301).members(), 4);
  // However little room there is, a single machine must do.
  EXPECT_EQ(Arrangement(settings, on_one_machine(8), 100'000).members(), 1);
}

TEST(Arrangement, HasAPlaceForEveryRankAndARankOnEveryPlace) {
  for (const Sort sort : {Sort::automatic, Sort::first, Sort::last, Sort::hybrid})
    for (const std::vector<int>& machines :
         {on_one_machine(12), spread_over(3, 12), spread_over(12, 12), std::vector{0, 0, 0, 5, 5, 9}}) {
      const Arrangement arrangement({sort, 100, 0}, machines, 250);
      int readers = 0;
      for (int rank = 0; rank < arrangement.ranks(); ++rank) {
        const Arrangement::Place& place = arrangement.place(rank);
        EXPECT_EQ(arrangement.rank_at(place.group, place.member), rank);
        // A rank's keeper is the same member, on the same machine, and reads its own bricks.
        EXPECT_EQ(arrangement.place(place.keeper).member, place.member);
        EXPECT_EQ(arrangement.place(place.keeper).keeper, place.keeper);
        EXPECT_EQ(machines[std::size_t(place.keeper)], machines[std::size_t(rank)]);
        readers += arrangement.readers(rank);
      }
      EXPECT_EQ(readers, arrangement.ranks());
    }
}

TEST(Sort, HasNames) {
  SortSettings settings;
  EXPECT_EQ(settings.sort, Sort::last);
  EXPECT_TRUE(set_sort(settings, "hybrid"));
  EXPECT_EQ(settings.sort, Sort::hybrid);
  EXPECT_FALSE(set_sort(settings, "middle"));
  EXPECT_EQ(settings.sort, Sort::hybrid);
}

/// Costs of the tiles of `pixels`; about one in three is zero.
std::vector<float> some_costs(const Rect& pixels, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<float> costs;
  for (const Rect& tile : tiles_of(pixels)) {
    const bool nothing = random() % 3 == 0;
    costs.push_back(nothing ? 0.0F : float(random() % 1000) * float(tile.pixels()));
  }
  return costs;
}

/// Sums tile by tile.
double sum_within(const Rect& pixels, const std::vector<float>& costs, const Rect& rect) {
  const std::vector<Rect> tiles = tiles_of(pixels);
  double sum = 0;
  for (std::size_t i = 0; i < tiles.size(); ++i)
    sum += double(costs[i]) * double(intersection(tiles[i], rect).pixels()) / double(tiles[i].pixels());
  return sum;
}

TEST(CostImage, TilesCoverItsPixelsOnce) {
  const Rect pixels{-37, 61, 150, 99};
  std::size_t covered = 0;
  for (const Rect& tile : tiles_of(pixels)) {
    EXPECT_EQ(intersection(tile, pixels), tile);
    EXPECT_LE(tile.width, 32);
    EXPECT_LE(tile.height, 32);
    covered += tile.pixels();
  }
  EXPECT_EQ(covered, pixels.pixels());
  EXPECT_TRUE(tiles_of({}).empty());
}

TEST(CostImage, SumsAreThoseOfPixelsOfAnyRectangle) {
  std::mt19937 random(5);
  for (const Rect& pixels : {Rect{0, 0, 256, 128}, Rect{-37, 61, 150, 99}, Rect{3, 5, 1, 70}}) {
    const std::vector<float> costs = some_costs(pixels, 3);
    const CostImage image(pixels, costs);
    for (int i = 0; i < 200; ++i) {
      const Rect rect{pixels.x - 20 + int(random() % 150), pixels.y - 20 + int(random() % 150),
                      int(random() % 120), int(random() % 120)};
      const double expected = sum_within(pixels, costs, rect);
      EXPECT_NEAR(image.within(rect), expected, 1e-9 * (1 + sum_within(pixels, costs, pixels)));
    }
  }
}

TEST(CostImage, CountsWhatIsNoNumberAsNothing) {
  const float costs[] = {std::nanf(""), -5, std::numeric_limits<float>::infinity(), 7};
  EXPECT_EQ(CostImage({0, 0, 64, 64}, costs).within({0, 0, 64, 64}), 7);
}

TEST(ImageLeaves, TileTheImageAndCostTheSame) {
  for (const Rect& pixels : {Rect{0, 0, 1024, 1024}, Rect{-30, 11, 700, 1300}}) {
    const std::vector<float> costs = some_costs(pixels, 11);
    const CostImage image(pixels, costs);
    for (int count = 1; count <= 16; ++count) {
      const std::vector<Rect> leaves = leaves_of_equal_cost(image, count);
      ASSERT_EQ(leaves.size(), std::size_t(count));
      std::size_t covered = 0;
      double least = std::numeric_limits<double>::infinity(), most = 0;
      for (const Rect& leaf : leaves) {
        covered += leaf.pixels();
        for (const Rect& other : leaves) EXPECT_TRUE(&other == &leaf || intersection(leaf, other).empty());
        least = std::min(least, image.within(leaf));
        most = std::max(most, image.within(leaf));
      }
      EXPECT_EQ(covered, pixels.pixels());
      // Leaves are not exactly equal, because cuts lie at multiples of four pixels.
      EXPECT_LE(most - least, 0.12 * image.within(pixels) / count) << count;
    }
  }
}

TEST(ImageLeaves, OfAnImageThatCostsNothingAreAlikeInPixels) {
  const Rect pixels{0, 0, 512, 256};
  const std::vector<float> costs(tiles_of(pixels).size());
  for (const Rect& leaf : leaves_of_equal_cost(CostImage(pixels, costs), 8))
    EXPECT_EQ(leaf.pixels(), pixels.pixels() / 8);
}

TEST(ImageLeaves, MoreThanThereArePixelsAreEmpty) {
  const Rect pixels{0, 0, 3, 2};
  const std::vector<float> costs(1, 1.0F);
  std::size_t covered = 0;
  for (const Rect& leaf : leaves_of_equal_cost(CostImage(pixels, costs), 16)) covered += leaf.pixels();
  EXPECT_EQ(covered, pixels.pixels());
  for (const Rect& leaf : leaves_of_equal_cost(CostImage({}, {}), 4)) EXPECT_TRUE(leaf.empty());
}

}  // namespace
}  // namespace understudy::compositor
