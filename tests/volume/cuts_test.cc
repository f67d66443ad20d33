// SPDX-License-Identifier: Apache-2.0
// Every way to cut a volume: the boxes tile it on block faces, the image stays the same, and costs are divided
// as evenly as block faces allow.
#include <gmock/gmock.h>

#include "tests/volume/parts.h"
#include "tests/volume/scenes.h"
#include "volume/block_costs.h"
#include "volume/partition.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

BlockCosts random_costs(const TexelBox& lattice, int edge, std::mt19937& random, double part_that_shows) {
  BlockCosts costs(lattice, edge);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (double& value : costs.values()) value = uniform(random) < part_that_shows ? 64 : 1;
  return costs;
}

/// Moves every plane to a random block face of the box that it cuts.
Partition shaken(Partition partition, const TexelBox& lattice, std::mt19937& random) {
  for (std::size_t i = 0; i < partition.splits.size(); ++i) {
    const TexelBox box = cut_boxes(partition, lattice)[i];
    Partition::Split& split = partition.splits[i];
    const int low = box.low[split.axis], high = box.high[split.axis];
    const int blocks = (high - low) / 8;
    split.cut = std::min(high, low + 8 * std::uniform_int_distribution<int>(0, blocks)(random));
  }
  return partition;
}

double cells_in(const TexelBox& box) {
  double cells = 1;
  for (int k = 0; k < 3; ++k) cells *= box.high[k] - box.low[k];
  return cells;
}

void expect_tiling(const std::vector<TexelBox>& boxes, const TexelBox& lattice, bool on_faces) {
  double cells = 0;
  for (std::size_t rank = 0; rank < boxes.size(); ++rank) {
    const TexelBox& box = boxes[rank];
    cells += cells_in(box);
    EXPECT_TRUE(is_empty(box) || contains(lattice, box));
    for (int k = 0; on_faces && !is_empty(box) && k < 3; ++k)
      EXPECT_EQ((box.low[k] - lattice.low[k]) % 8, 0) << "rank " << rank;
    for (std::size_t other = 0; other < rank; ++other)
      EXPECT_TRUE(is_empty(intersection(box, boxes[other]))) << rank << " overlaps " << other;
  }
  EXPECT_EQ(cells, cells_in(lattice));
}

TEST(Cuts, TileTheLatticeOnBlockFacesWhereverTheyLie) {
  const unsigned seed = 2306;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> size(70, 140);
  for (int ranks = 1; ranks <= 24; ++ranks) {
    const VolumeDescription volume = describe({size(random), size(random), size(random)}, TexelType::u8,
                                              ranks % 3 == 0 ? Wrap::repeat : Wrap::edge);
    const TexelBox lattice = cell_lattice(volume).box();
    const BlockCosts costs = random_costs(lattice, ranks % 2 == 0 ? 8 : 16, random, 0.2);
    for (const Partition& partition :
         {by_blocks(volume, ranks), by_factors(volume, ranks), by_cost(volume, ranks, CostSums(costs))}) {
      EXPECT_EQ(partition.ranks, ranks);
      // 23 ranks along one axis do not fit into nine blocks, so cells are cut there.
      const std::array<int, 3> parts = factors(volume, ranks);
      expect_tiling(boxes(partition, volume), lattice, *std::ranges::max_element(parts) <= 8);
      const Partition moved = shaken(partition, lattice, random);
      expect_tiling(boxes(moved, volume), lattice, *std::ranges::max_element(parts) <= 8);
    }
  }
}

TEST(Cuts, FactorsFollowTheProportionsOfTheVolume) {
  const auto described = [](int x, int y, int z) { return describe({x, y, z}, TexelType::u8); };
  EXPECT_EQ(factors(described(64, 64, 64), 8), (std::array<int, 3>{2, 2, 2}));
  EXPECT_EQ(factors(described(512, 64, 64), 8), (std::array<int, 3>{8, 1, 1}));
  EXPECT_EQ(factors(described(64, 128, 256), 8), (std::array<int, 3>{1, 2, 4}));
  EXPECT_EQ(factors(described(64, 200, 64), 7), (std::array<int, 3>{1, 7, 1}));
  const auto parts = boxes(by_factors(described(97, 97, 97), 12), described(97, 97, 97));
  double largest = 0;
  for (const TexelBox& box : parts) largest = std::max(largest, cells_in(box));
  EXPECT_LT(largest, 1.4 * 96 * 96 * 96 / 12);
}

TEST(Cuts, ByCostDividesCostsAsFairlyAsFacesAllow) {
  const unsigned seed = 2307;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  for (int trial = 0; trial < 30; ++trial) {
    const int ranks = 2 + trial % 7;
    const VolumeDescription volume = describe({257, 201, 161}, TexelType::u8);
    const TexelBox lattice = cell_lattice(volume).box();
    // Almost all cost lies in a ball at a random position.
    BlockCosts costs(lattice, 8);
    std::uniform_real_distribution<double> uniform(0.2, 0.8);
    const Vec3 centre{uniform(random), uniform(random), uniform(random)};
    const auto [nx, ny, nz] = costs.counts();
    for (int z = 0; z < nz; ++z)
      for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x) {
          const Vec3 t{(x + 0.5) / nx, (y + 0.5) / ny, (z + 0.5) / nz};
          costs.values()[costs.index({x, y, z})] = length(subtract(t, centre)) < 0.25 ? 100 : 1;
        }
    const CostSums sums(costs);
    const auto worst = [&](const Partition& partition) {
      double most = 0;
      for (const TexelBox& box : boxes(partition, volume)) most = std::max(most, sums.within(box));
      return most * ranks / sums.within(lattice);
    };
    const double fair = worst(by_cost(volume, ranks, sums)), blocks = worst(by_blocks(volume, ranks));
    EXPECT_LT(fair, 1.35) << "trial " << trial;
    EXPECT_LE(fair, blocks * 1.1) << "trial " << trial;
  }
}

TEST(Cuts, SumsAreThoseOfTheirCubes) {
  const unsigned seed = 2308;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  const TexelBox lattice{{-1, 0, 3}, {66, 41, 90}};
  const BlockCosts costs = random_costs(lattice, 16, random, 0.5);
  EXPECT_EQ(costs.counts(), (std::array<int, 3>{5, 3, 6}));
  const CostSums sums(costs);
  for (int trial = 0; trial < 100; ++trial) {
    TexelBox box;
    for (int k = 0; k < 3; ++k) {
      std::uniform_int_distribution<int> cell(lattice.low[k], lattice.high[k]);
      const int a = cell(random), b = cell(random);
      box.low[k] = std::min(a, b);
      box.high[k] = std::max(a, b);
    }
    double expected = 0;
    for (int z = 0; z < 6; ++z)
      for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 5; ++x) {
          bool inside = true;
          const std::array<int, 3> cube{x, y, z};
          for (int k = 0; k < 3; ++k) {
            const int cell = lattice.low[k] + 16 * cube[k];
            inside = inside && cell >= box.low[k] && cell < box.high[k];
          }
          if (inside) expected += costs.values()[costs.index(cube)];
        }
    EXPECT_EQ(sums.within(box), expected) << "trial " << trial;
  }
  EXPECT_THROW(BlockCosts(lattice, 12), std::invalid_argument);
  EXPECT_THROW(BlockCosts({}, 8), std::invalid_argument);
}

TEST(Cuts, GiveTheSameImageWhereverTheyLie) {
  const unsigned seed = 2309;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  double worst = 0;
  for (int ranks = 2; ranks <= 9; ++ranks) {
    const Texture texture = noise(describe({45, 37, 61}, TexelType::u8), unsigned(ranks));
    const TexelBox lattice = cell_lattice(texture.description).box();
    const RenderRequest request = request_for(texture, usual_camera(45, 39), 45, 39, 80);
    const Whole one = render_whole(texture, request);
    const BlockCosts costs = random_costs(lattice, 8, random, 0.1);
    const std::vector<Partition> partitions{by_factors(texture.description, ranks),
                                            by_cost(texture.description, ranks, CostSums(costs)),
                                            shaken(by_factors(texture.description, ranks), lattice, random),
                                            shaken(by_blocks(texture.description, ranks), lattice, random)};
    for (const Partition& partition : partitions) {
      const Whole many = render_parts(texture, request, KdTree(texture.description, partition));
      worst = std::max(worst, difference(one.image, many.image).max);
      EXPECT_EQ(one.counts.samples, many.counts.samples) << ranks << " ranks";
    }
  }
  std::printf("largest difference %.2e\n", worst);
  EXPECT_LE(worst, 1e-5);
}

TEST(Cuts, RefuseATreeThatIsNone) {
  const VolumeDescription volume = describe({64, 64, 64}, TexelType::u8);
  const Partition good = by_blocks(volume, 3);
  EXPECT_NO_THROW(KdTree(volume, good));
  std::vector<Partition> wrong(7, good);
  wrong[0].splits.pop_back();
  wrong[1].splits[0].low = wrong[1].splits[1].low;  // a rank twice
  wrong[2].splits[1].high = 0;                      // a loop
  wrong[3].splits[1].high = ~3;                     // no such rank
  wrong[4].splits[0].cut = 64;                      // outside
  wrong[5].splits[0].axis = 3;
  wrong[6].splits[0].high = 2;  // no such split
  for (const Partition& partition : wrong) EXPECT_THROW(KdTree(volume, partition), std::invalid_argument);
}

}  // namespace
}  // namespace understudy::volume::testing
