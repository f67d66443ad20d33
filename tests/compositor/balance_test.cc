// SPDX-License-Identifier: Apache-2.0
// Decisions of the balancers for known costs and speeds.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "compositor/balance/balancer.h"
#include "compositor/balance/block_cache.h"
#include "compositor/balance/moves.h"
#include "compositor/balance/tree.h"
#include "tests/volume/scenes.h"
#include "volume/cell_lattice.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/raycast/expected_samples.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::compositor {
namespace {

using ::testing::IsEmpty;
using volume::BlockCosts;
using volume::CostSums;
using volume::Partition;
using volume::TexelBox;
using volume::testing::describe;

/// Ranks that draw exactly as their costs predict, except for noise; counts how planes move.
struct Group {
  volume::VolumeDescription description = describe({257, 257, 257}, volume::TexelType::u8);
  TexelBox lattice = volume::cell_lattice(description).box();
  BlockCosts costs{lattice, 8};
  std::vector<double> relative_cost;
  double noise = 0.05;
  double ms_per_block = 1e-4;
  std::vector<std::size_t> most_blocks;
  Partition partition;
  std::vector<RankWork> work;
  std::mt19937 random;
  std::vector<int> last_way;
  int moves = 0;
  int reversals = 0;
  int largest_step = 0;

  Group(int ranks, unsigned seed) : relative_cost(std::size_t(ranks), 1.0), random(seed) {
    partition = volume::by_blocks(description, ranks);
    last_way.resize(partition.splits.size());
    std::uniform_real_distribution<double> uniform(0, 1);
    for (double& value : costs.values()) value = uniform(random) < 0.3 ? 1000 : 4;
  }

  /// Draws one image; returns the slowest rank's time relative to a perfect balance, without noise.
  double draw(Balancer& balancer) {
    const Partition next = balancer.decide({partition, lattice, work, costs, ms_per_block, most_blocks});
    for (std::size_t i = 0; i < next.splits.size(); ++i) {
      const int step = next.splits[i].cut - partition.splits[i].cut;
      if (step == 0) continue;
      const int way = step > 0 ? 1 : -1;
      ++moves;
      reversals += way == -last_way[i];
      last_way[i] = way;
      largest_step = std::max(largest_step, std::abs(step));
    }
    partition = next;
    const CostSums sums(costs);
    work.clear();
    double most = 0, all = 0, speed = 0;
    std::uniform_real_distribution<double> uniform(1 - noise, 1 + noise);
    const auto boxes = volume::boxes(partition, description);  // throws if they do not tile
    for (std::size_t rank = 0; rank < boxes.size(); ++rank) {
      const double samples = sums.within(boxes[rank]), ms = 1e-4 * samples * relative_cost[rank];
      work.push_back({ms * uniform(random), std::uint64_t(samples)});
      most = std::max(most, ms);
      all += 1e-4 * samples;
      speed += 1 / relative_cost[rank];
    }
    return most * speed / all;
  }
};

TEST(Balance, HasThreeNames) {
  Balance balance = Balance::off;
  EXPECT_TRUE(set_balance(balance, "muller"));
  EXPECT_EQ(balance, Balance::muller);
  EXPECT_TRUE(set_balance(balance, "predicted"));
  EXPECT_EQ(balance, Balance::predicted);
  EXPECT_FALSE(set_balance(balance, "best"));
  EXPECT_EQ(balance, Balance::predicted);
  EXPECT_TRUE(set_balance(balance, "off"));
  EXPECT_EQ(make_balancer(balance), nullptr);
}

TEST(Balance, PredictingEvensOutASlowRankInTwoMovesAndThenRests) {
  const unsigned seed = 2401;
  std::printf("seed %u\n", seed);
  for (int ranks = 2; ranks <= 8; ++ranks) {
    Group group(ranks, seed + unsigned(ranks));
    const auto balancer = predicting_balancer();
    for (int image = 0; image < 20; ++image) group.draw(*balancer);
    const int before = group.moves;
    group.relative_cost[std::size_t(ranks) / 2] = 4;
    const double unbalanced = group.draw(*balancer);
    for (int image = 0; image < 6; ++image) group.draw(*balancer);
    const double balanced = group.draw(*balancer);
    const int moved = group.moves - before;
    // Two images until the measurements count, then one or two decisions for every split.
    EXPECT_LT(balanced, 1.2) << ranks << " ranks";
    EXPECT_LT(balanced, 0.6 * unbalanced) << ranks << " ranks";
    EXPECT_LE(moved, 2 * (ranks - 1)) << ranks << " ranks";
    const int settled = group.moves;
    for (int image = 0; image < 300; ++image) group.draw(*balancer);
    EXPECT_LE(group.moves - settled, ranks) << ranks << " ranks: planes wander though nothing changes";
  }
}

TEST(Balance, NoRankComesToHoldMoreThanItHasMemoryFor) {
  for (const Balance balance : {Balance::predicted, Balance::muller})
    for (const int ranks : {2, 3, 5, 8}) {
      Group free(ranks, 5), bound(ranks, 5);
      // One rank is so fast that nearly all of the volume would be its share.
      const std::size_t fast = std::size_t(ranks) / 2;
      for (Group* group : {&free, &bound}) {
        std::ranges::fill(group->relative_cost, 50.0);
        group->relative_cost[fast] = 1;
      }
      const auto held = [&](const Group& group, std::size_t rank) {
        return blocks_in(volume::boxes(group.partition, group.description)[rank]);
      };
      for (std::size_t rank = 0; rank < std::size_t(ranks); ++rank)
        bound.most_blocks.push_back(rank == fast ? held(bound, rank) * 3 / 2
                                                 : std::numeric_limits<std::size_t>::max());
      const auto one = make_balancer(balance), other = make_balancer(balance);
      double unlimited = 0, limited = 0;
      std::size_t most = 0;
      for (int image = 0; image < 60; ++image) {
        unlimited = free.draw(*one);
        limited = bound.draw(*other);
        ASSERT_LE(held(bound, fast), bound.most_blocks[fast]);
        most = std::max(most, held(bound, fast));
      }
      EXPECT_GT(held(free, fast), bound.most_blocks[fast]) << "the limit must be felt";
      EXPECT_GT(most, bound.most_blocks[fast] * 2 / 3) << "planes move as far as there is room";
      EXPECT_GT(limited, unlimited);
    }
}

TEST(Balance, PredictingLearnsWhatExpectationDoesNotKnow) {
  // Half of the volume costs a fifth of what is expected, as behind something opaque.
  const unsigned seed = 2402;
  std::printf("seed %u\n", seed);
  for (const int ranks : {2, 4, 5}) {
    Group group(ranks, seed);
    BlockCosts really = group.costs;
    const auto [nx, ny, nz] = really.counts();
    for (int z = 0; z < nz; ++z)
      for (int y = 0; y < ny; ++y)
        for (int x = nx / 2; x < nx; ++x) really.values()[really.index({x, y, z})] *= 0.2;
    const auto balancer = predicting_balancer();
    double before = 0, after = 0;
    for (int image = 0; image < 40; ++image) {
      const Partition next =
          balancer->decide({group.partition, group.lattice, group.work, group.costs, group.ms_per_block});
      group.partition = next;
      const CostSums sums(really);
      group.work.clear();
      double most = 0, all = 0;
      for (const TexelBox& box : volume::boxes(next, group.description)) {
        const double samples = sums.within(box);
        group.work.push_back({1e-4 * samples, std::uint64_t(samples)});
        most = std::max(most, samples);
        all += samples;
      }
      (image == 0 ? before : after) = most * ranks / all;
    }
    std::printf("%d ranks: slowest %.2f times the mean, then %.2f\n", ranks, before, after);
    EXPECT_LT(after, 1.15) << ranks;
    EXPECT_GT(before, 1.25) << ranks;
  }
}

TEST(Balance, PredictingStaysWhereMovingCostsMoreThanItGains) {
  Group group(4, 2403);
  group.relative_cost[0] = 1.3;
  group.ms_per_block = 10;  // an image takes some 300 ms
  const auto balancer = predicting_balancer();
  for (int image = 0; image < 5; ++image) group.draw(*balancer);
  EXPECT_EQ(group.moves, 0);
  group.ms_per_block = 1e-4;
  for (int image = 0; image < 5; ++image) group.draw(*balancer);
  EXPECT_GT(group.moves, 0);
}

TEST(Balance, OneInterruptionMovesNothing) {
  Group group(4, 2404);
  const auto balancer = predicting_balancer();
  for (int image = 0; image < 30; ++image) group.draw(*balancer);
  const Partition settled = group.partition;
  group.work[2].ms *= 5;
  for (int image = 0; image < 4; ++image) group.draw(*balancer);
  EXPECT_EQ(group.partition, settled);
}

TEST(Balance, MullerMovesOneSliceAtATimeAndKeepsTheInequality) {
  const unsigned seed = 2405;
  std::printf("seed %u\n", seed);
  for (int ranks = 2; ranks <= 8; ++ranks) {
    Group group(ranks, seed);
    group.relative_cost[0] = 4;
    const auto balancer = muller_balancer();
    const double before = group.draw(*balancer);
    double after = before;
    for (int image = 0; image < 60; ++image) after = group.draw(*balancer);
    EXPECT_LE(group.largest_step, 8);
    EXPECT_LT(after, before) << ranks << " ranks";
  }
  // Two ranks whose times differ by what one slice costs, or by a little more.
  Group group(2, seed);
  const auto balancer = muller_balancer();
  const double all_blocks = 32 * 32 * 32, slice = 32 * 32;
  for (const double over : {0.98, 1.02}) {
    const double mean = 100, difference = slice * (2 * mean / all_blocks + group.ms_per_block) * over;
    group.work = {{mean + difference / 2, 1}, {mean - difference / 2, 1}};
    const Partition next =
        balancer->decide({group.partition, group.lattice, group.work, group.costs, group.ms_per_block});
    const int axis = group.partition.splits[0].axis;
    EXPECT_EQ(next.splits[0].cut, group.partition.splits[0].cut - (over > 1 ? 8 : 0)) << "axis " << axis;
  }
}

TEST(Balance, MullerHesitatesToGoBack) {
  Group group(2, 2406);
  MullerSettings firm;
  firm.raised_by = 1e9;
  const auto balancer = muller_balancer(firm);
  const auto decide = [&](double low_ms, double high_ms) {
    group.work = {{low_ms, 1}, {high_ms, 1}};
    group.partition =
        balancer->decide({group.partition, group.lattice, group.work, group.costs, group.ms_per_block});
    return group.partition.splits[0].cut;
  };
  const int middle = group.partition.splits[0].cut;
  EXPECT_EQ(decide(100, 50), middle - 8);
  EXPECT_EQ(decide(50, 100), middle - 8);   // this would be back
  EXPECT_EQ(decide(100, 50), middle - 16);  // this is on
}

TEST(Balance, DecisionsAreTheSameOnEveryRank) {
  for (const Balance balance : {Balance::muller, Balance::predicted}) {
    Group here(6, 2407);
    const auto mine = make_balancer(balance), theirs = make_balancer(balance);
    std::uniform_real_distribution<double> uniform(0.2, 5);
    int moves = 0;
    for (int image = 0; image < 50; ++image) {
      const BalanceInput input{here.partition, here.lattice, here.work, here.costs, here.ms_per_block};
      const Partition next = mine->decide(input);
      ASSERT_EQ(next, theirs->decide(input));
      moves += next != here.partition;
      here.partition = next;
      here.work.clear();
      for (int rank = 0; rank < 6; ++rank) here.work.push_back({uniform(here.random), 1000});
    }
    EXPECT_GT(moves, 0);
  }
}

TEST(Balance, AnyTimesLeaveBoxesThatTileTheVolume) {
  const unsigned seed = 2408;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  for (int trial = 0; trial < 40; ++trial) {
    const int ranks = 1 + trial % 13;
    const auto size = [&] { return std::uniform_int_distribution<int>(1, 120)(random); };
    const volume::VolumeDescription description = describe({size(), size(), size()}, volume::TexelType::u8);
    const TexelBox lattice = volume::cell_lattice(description).box();
    const auto balancer = make_balancer(trial % 2 == 0 ? Balance::muller : Balance::predicted);
    Partition partition = volume::by_blocks(description, ranks);
    BlockCosts costs(lattice, trial % 3 == 0 ? 16 : 8);
    std::vector<RankWork> work;
    for (int image = 0; image < 30; ++image) {
      for (double& value : costs.values()) value = double(random() % 4 == 0 ? random() % 1000 : 0);
      partition = balancer->decide({partition, lattice, work, costs, 1e-3});
      ASSERT_NO_THROW(volume::boxes(partition, description)) << "trial " << trial;
      work.clear();
      for (int rank = 0; rank < ranks; ++rank)
        work.push_back({double(random() % 100), random() % 5 == 0 ? 0 : random() % 100000});
    }
  }
}

TEST(Moves, BringEveryBlockThatIsMissingOnceFromItsOwner) {
  const unsigned seed = 2409;
  std::printf("seed %u\n", seed);
  std::mt19937 random(seed);
  for (int trial = 0; trial < 40; ++trial) {
    const int ranks = 1 + trial % 9;
    volume::VolumeDescription description = describe({70, 41, 55}, volume::TexelType::u8);
    description.ghost_layer = trial % 3;
    const TexelBox lattice = volume::cell_lattice(description).box();
    const auto some_boxes = [&] {
      BlockCosts costs(lattice, 8);
      for (double& value : costs.values()) value = double(random() % 100);
      return volume::boxes(volume::by_cost(description, ranks, CostSums(costs)), description);
    };
    const auto before = some_boxes(), after = some_boxes();
    const auto moved = moves(description, before, after);
    for (int to = 0; to < ranks; ++to) {
      const TexelBox had = blocks_kept(description, before[std::size_t(to)]),
                     has = blocks_kept(description, after[std::size_t(to)]);
      for (int z = 0; z < 7; ++z)
        for (int y = 0; y < 5; ++y)
          for (int x = 0; x < 9; ++x) {
            const TexelBox block{{x, y, z}, {x + 1, y + 1, z + 1}};
            int came = 0;
            for (const BlockMove& move : moved)
              if (move.to == to && volume::contains(move.blocks, block)) {
                ++came;
                EXPECT_TRUE(volume::contains(blocks_owned(lattice, before[std::size_t(move.from)]), block));
                EXPECT_NE(move.from, to);
              }
            EXPECT_EQ(came, volume::contains(has, block) && !volume::contains(had, block)) << "trial " << trial;
          }
    }
    EXPECT_THAT(moves(description, before, before), IsEmpty());
  }
}

TEST(BlockCache, ForgetsTheLeastRecentAndWhatHasChanged) {
  constexpr std::size_t entry = BlockCache::entry_bytes;
  BlockCache cache(2 * entry + 100);
  const auto packed = [](std::size_t bytes, int value) {
    return std::vector<std::byte>(bytes, std::byte(value));
  };
  cache.put({0, 0, 0}, packed(40, 1));
  cache.put({1, 0, 0}, packed(40, 2));
  cache.put({2, 0, 0}, packed(40, 3));
  EXPECT_FALSE(cache.holds({0, 0, 0}));
  EXPECT_EQ(cache.bytes(), 2 * entry + 80);
  EXPECT_EQ(cache.take({1, 0, 0}), packed(40, 2));
  EXPECT_EQ(cache.take({1, 0, 0}), std::nullopt);
  EXPECT_EQ(cache.bytes(), entry + 40);
  cache.put({2, 0, 0}, packed(10, 4));  // replaces the first
  EXPECT_EQ(cache.bytes(), entry + 10);
  cache.put({5, 5, 5}, packed(10, 5));
  cache.drop({{0, 0, 0}, {3, 3, 3}});
  EXPECT_FALSE(cache.holds({2, 0, 0}));
  EXPECT_TRUE(cache.holds({5, 5, 5}));
  cache.put({0, 0, 0}, packed(entry + 101, 1));  // more than the cache may hold
  EXPECT_EQ(cache.bytes(), 0U);
  cache.put({0, 0, 0}, packed(1, 1));
  cache.clear();
  EXPECT_EQ(cache.bytes(), 0U);
}

TEST(ExpectedSamples, AreThoseThatAreTaken) {
  using namespace volume::testing;
  using volume::multiply;
  // Nothing is empty or opaque: every sample in a block is taken.
  const Texture texture = sampled(describe({65, 49, 57}, volume::TexelType::u8), constant_field(0.5));
  const volume::BrickStore store = filled(texture);
  for (const bool on_steps : {false, true})
    for (const bool near : {false, true}) {
      volume::RenderRequest request =
          near ? request_for(
                     texture,
                     multiply(perspective(60, 45.0 / 39, 0.01, 10),
                              multiply(look_at({0.1, -0.05, -0.25}, {-0.1, 0.1, -1}, {0, 1, 0}), unit_cube())),
                     90, 78, 120)
               : request_for(texture, usual_camera(90, 78), 90, 78, 120);
      request.classification = smooth_table(256, 0.001F);
      if (on_steps) request.steps = volume::RaySteps{.metric = {64, 0, 0, 0, 48, 0, 0, 0, 56}, .first = 0.5};
      volume::Image image(request.window);
      volume::FrameCounts counts;
      volume::raycast(store, request, image, counts);
      volume::BlockCosts costs(volume::cell_lattice(texture.description).box(), near ? 16 : 8);
      volume::add_expected_samples(store, request, costs);
      const double expected = CostSums(costs).within(costs.lattice());
      std::printf("%s, %s: %.0f samples expected, %llu taken\n", on_steps ? "steps" : "planes",
                  near ? "inside" : "outside", expected, static_cast<unsigned long long>(counts.samples));
      EXPECT_NEAR(expected / double(counts.samples), 1, near ? 0.3 : 0.1);
    }
}

}  // namespace
}  // namespace understudy::compositor
