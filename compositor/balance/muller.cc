// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "compositor/balance/balancer.h"
#include "compositor/balance/block_edge.h"
#include "compositor/balance/tree.h"
#include "volume/brick/brick_store.h"
#include "volume/texel_box.h"

namespace understudy::compositor {

using volume::Partition;
using volume::TexelBox;

namespace {

class MullerBalancer : public Balancer {
 public:
  explicit MullerBalancer(const MullerSettings& settings) : settings_(settings) {}

  Partition decide(const BalanceInput& input) override {
    Partition partition = input.partition;
    if (input.work.empty()) return partition;
    factors_.resize(partition.splits.size(), {settings_.hysteresis, settings_.hysteresis});
    std::vector<std::optional<std::size_t>> moved(partition.splits.size());  // null, or `towards`
    walk_splits(partition, input.lattice, [&](std::size_t i, const TexelBox& box) {
      Partition::Split& split = partition.splits[i];
      const auto axis = std::size_t(split.axis);
      // Planes further up may have moved, so that this plane lies outside its box.
      split.cut = allowed_cut(partition, i, box, input.lattice, block_edge, split.cut);
      const auto mean_ms = [&](int child) {
        const std::vector<int> ranks = ranks_under(partition, child);
        double sum = 0;
        for (const int rank : ranks) sum += input.work[std::size_t(rank)].ms;
        return std::array{sum / double(ranks.size()), sum};
      };
      const auto [low_ms, low_sum] = mean_ms(split.low);
      const auto [high_ms, high_sum] = mean_ms(split.high);
      const std::size_t towards = low_ms > high_ms ? 0 : 1;  // the side that gives a slice; 0: low, 1: high
      TexelBox slice = box;
      slice.high[axis] = std::min(box.high[axis], box.low[axis] + block_edge);
      const auto blocks = double(blocks_in(slice));
      const double ms_per_block = (low_sum + high_sum) / double(blocks_in(box));
      const std::array<double, 2>& factor = factors_[i];
      const double cost = blocks * ms_per_block + blocks * factor[towards] * input.ms_per_block;
      if (!(cost < std::abs(low_ms - high_ms))) return;
      const int cut = allowed_cut(partition, i, box, input.lattice, block_edge,
                                  split.cut + (towards == 0 ? -block_edge : block_edge));
      if (cut == split.cut) return;
      split.cut = cut;
      moved[i] = towards;
    });
    partition = with_room(input.partition, partition, input.lattice, input.most_blocks);
    for (std::size_t i = 0; i < factors_.size(); ++i) {
      if (!moved[i] || partition.splits[i].cut == input.partition.splits[i].cut) continue;
      factors_[i][1 - *moved[i]] += settings_.raised_by;
      factors_[i][*moved[i]] = std::max(0.0, factors_[i][*moved[i]] - settings_.lowered_by);
    }
    return partition;
  }

 private:
  MullerSettings settings_;
  std::vector<std::array<double, 2>> factors_;  // by split: for moving its plane down, and up
};

}  // namespace

std::unique_ptr<Balancer> muller_balancer(const MullerSettings& settings) {
  return std::make_unique<MullerBalancer>(settings);
}

}  // namespace understudy::compositor
