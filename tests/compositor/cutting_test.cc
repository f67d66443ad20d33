// SPDX-License-Identifier: Apache-2.0
// Partitions by the expected costs of blocks.
#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "compositor/balance/balancer.h"
#include "compositor/balance/tree.h"
#include "tests/volume/scenes.h"
#include "volume/cell_lattice.h"

namespace understudy::compositor {
namespace {

using volume::BlockCosts;
using volume::CostSums;
using volume::Partition;
using volume::PartitionMethod;
using volume::TexelBox;

constexpr int ranks = 8;

/// A volume whose blocks show something in one corner only.
struct Corner {
  volume::VolumeDescription description = volume::testing::describe({257, 193, 129}, volume::TexelType::u8);
  TexelBox lattice = volume::cell_lattice(description).box();
  BlockCosts costs{lattice, 8};
  Partition partition = volume::by_blocks(description, ranks);
  std::vector<RankWork> work;
  double ms_per_block = 0;
  std::vector<std::size_t> most_blocks;

  /// Sets costs below this part of each axis only.
  void show_below(double part) {
    const auto counts = costs.counts();
    for (int z = 0; z < counts[2]; ++z)
      for (int y = 0; y < counts[1]; ++y)
        for (int x = 0; x < counts[0]; ++x) {
          const bool shows = x < part * counts[0] && y < part * counts[1] && z < part * counts[2];
          costs.values()[costs.index({x, y, z})] = shows ? 1000 : 4;
        }
  }

  /// Samples of the busiest rank, relative to the mean.
  double busiest() const {
    const CostSums sums(costs);
    double most = 0;
    for (const TexelBox& box : boxes_of(partition, lattice)) most = std::max(most, sums.within(box));
    return most * ranks / sums.within(lattice);
  }

  Partition decided_by(Balancer& balancer) const {
    return balancer.decide({partition, lattice, work, costs, ms_per_block, most_blocks});
  }
};

TEST(Cutting, SharesOutWhatOneCornerShows) {
  Corner corner;
  corner.show_below(0.5);
  EXPECT_GT(corner.busiest(), 3);
  corner.partition = corner.decided_by(*cutting_balancer(nullptr));
  EXPECT_LT(corner.busiest(), 1.1);
}

TEST(Cutting, StaysWhereTheGainIsLessThanWhatBlocksTakeToTravel) {
  Corner corner;
  corner.show_below(0.4);
  const auto balancer = cutting_balancer(nullptr);
  corner.partition = corner.decided_by(*balancer);
  const Partition before = corner.partition;
  corner.show_below(0.8);
  corner.work.assign(ranks, {1.0, 1000000});
  corner.ms_per_block = 1000;
  EXPECT_EQ(corner.decided_by(*balancer), before);
  corner.ms_per_block = 1e-6;
  EXPECT_NE(corner.decided_by(*balancer), before);
}

TEST(Cutting, StaysWhereARankWouldHoldMoreThanItHasRoomFor) {
  Corner corner;
  corner.show_below(0.4);
  for (const TexelBox& box : boxes_of(corner.partition, corner.lattice))
    corner.most_blocks.push_back(blocks_in(box));
  EXPECT_EQ(corner.decided_by(*cutting_balancer(nullptr)), corner.partition);
}

TEST(Cutting, LeavesLaterImagesToAnotherBalancer) {
  Corner corner;
  corner.show_below(0.4);
  const auto balancer = make_balancer(Balance::predicted, PartitionMethod::cost);
  corner.partition = corner.decided_by(*balancer);
  const Partition first = corner.partition;
  corner.work.assign(ranks, {1.0, 1000000});
  corner.work.front().ms = 10;
  for (int image = 0; image < 4; ++image) corner.partition = corner.decided_by(*balancer);
  ASSERT_EQ(corner.partition.splits.size(), first.splits.size());
  for (std::size_t i = 0; i < first.splits.size(); ++i)
    EXPECT_EQ(corner.partition.splits[i].axis, first.splits[i].axis) << "its planes move, its tree stays";
  EXPECT_NE(corner.partition, first);
}

TEST(Cutting, IsTheSameOnAllRanks) {
  std::mt19937 random(77);
  Corner corner;
  const auto mine = cutting_balancer(nullptr), theirs = cutting_balancer(nullptr);
  for (int image = 0; image < 20; ++image) {
    for (double& value : corner.costs.values()) value = random() % 100 < 20 ? double(random() % 1000) : 1;
    const Partition here = corner.decided_by(*mine);
    ASSERT_EQ(here, corner.decided_by(*theirs));
    corner.partition = here;
    corner.work.assign(ranks, {double(1 + random() % 9), 100000});
  }
}

}  // namespace
}  // namespace understudy::compositor
