// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "compositor/balance/balancer.h"
#include "compositor/balance/moves.h"
#include "compositor/balance/tree.h"
#include "volume/block_costs.h"

namespace understudy::compositor {

using volume::CostSums;
using volume::Partition;
using volume::TexelBox;

namespace {

double dearest(const CostSums& sums, std::span<const TexelBox> boxes) {
  double most = 0;
  for (const TexelBox& box : boxes) most = std::max(most, sums.within(box));
  return most;
}

bool have_room(std::span<const TexelBox> boxes, std::span<const std::size_t> most_blocks) {
  for (std::size_t rank = 0; rank < boxes.size() && !most_blocks.empty(); ++rank)
    if (blocks_in(boxes[rank]) > most_blocks[rank]) return false;
  return true;
}

/// Mean time per sample over all ranks; null if they took no samples.
std::optional<double> ms_of_sample(std::span<const RankWork> work) {
  double ms = 0;
  double samples = 0;
  for (const RankWork& rank : work) {
    ms += rank.ms;
    samples += double(rank.samples);
  }
  return samples > 0 ? std::optional(ms / samples) : std::nullopt;
}

class CuttingBalancer : public Balancer {
 public:
  CuttingBalancer(std::unique_ptr<Balancer> then, const CuttingSettings& settings)
      : then_(std::move(then)), settings_(settings) {}

  Partition decide(const BalanceInput& input) override {
    if (cut_ && then_) return then_->decide(input);
    // The first images may show nothing.
    cut_ = CostSums(input.costs).within(input.lattice) > 0;
    return recut(input);
  }

 private:
  Partition recut(const BalanceInput& input) const {
    const CostSums sums(input.costs);
    const Partition fair = volume::by_cost(input.partition.ranks, sums);
    const std::vector<TexelBox> now = boxes_of(input.partition, input.lattice);
    const std::vector<TexelBox> then = boxes_of(fair, input.lattice);
    const double stay = dearest(sums, now);
    const double gain = stay - dearest(sums, then);
    if (!have_room(then, input.most_blocks) || !(gain > settings_.least_gain * stay)) return input.partition;
    // Before anything is measured, the volume is assumed to be shown often enough for the cut to pay.
    const auto sample_ms = ms_of_sample(input.work);
    const double move_ms = double(most_blocks_moved(input.lattice, now, then)) * input.ms_per_block;
    return !sample_ms || settings_.horizon * gain * *sample_ms > move_ms ? fair : input.partition;
  }

  std::unique_ptr<Balancer> then_;
  CuttingSettings settings_;
  bool cut_ = false;
};

}  // namespace

std::unique_ptr<Balancer> cutting_balancer(std::unique_ptr<Balancer> then, const CuttingSettings& settings) {
  return std::make_unique<CuttingBalancer>(std::move(then), settings);
}

}  // namespace understudy::compositor
