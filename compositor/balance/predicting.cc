// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "compositor/balance/balancer.h"
#include "compositor/balance/moves.h"
#include "compositor/balance/tree.h"
#include "volume/texel_box.h"

namespace understudy::compositor {

using volume::BlockCosts;
using volume::CostSums;
using volume::Partition;
using volume::TexelBox;

namespace {

/// Milliseconds per sample on one rank, smoothed over its measurements.
class RelativeCost {
 public:
  bool known() const { return measured_ > 0; }
  double value() const { return value_; }
  /// Mean deviation of single measurements from the expected value, as a part of it.
  double scatter() const { return scatter_; }

  void measure(double ms_per_sample) {
    recent_[measured_ % recent_.size()] = ms_per_sample;
    ++measured_;
    if (measured_ == 1) {
      value_ = ms_per_sample;
      return;
    }
    std::array<double, 3> sorted = recent_;
    const auto end = sorted.begin() + std::ptrdiff_t(std::min(measured_, sorted.size()));
    std::sort(sorted.begin(), end);
    // Of two measurements, the one nearer to the old value: a single outlier changes nothing.
    double median = sorted[1];
    if (measured_ == 2 && std::abs(sorted[0] - value_) < std::abs(sorted[1] - value_)) median = sorted[0];
    const double off = std::abs(median - value_);
    constexpr double slowly = 0.15, surprise = 3, at_least = 0.15, outlier = 0.2;
    if (off > value_ * std::max(at_least, surprise * scatter_)) {
      value_ = median;
      return;
    }
    value_ += slowly * (median - value_);
    scatter_ += slowly * (std::min(outlier, std::abs(ms_per_sample - value_) / value_) - scatter_);
  }

 private:
  std::array<double, 3> recent_{};
  std::size_t measured_ = 0;
  double value_ = 0;
  double scatter_ = 0;
};

class PredictingBalancer : public Balancer {
 public:
  explicit PredictingBalancer(const PredictingSettings& settings) : settings_(settings) {}

  Partition decide(const BalanceInput& input) override {
    const auto ranks = std::size_t(input.partition.ranks);
    relative_cost_.resize(ranks);
    if (weights_.size() != input.costs.values().size()) {
      weights_.assign(input.costs.values().size(), 1.0F);
      predicted_.clear();
    }
    const std::vector<TexelBox> now = boxes_of(input.partition, input.lattice);
    if (!input.work.empty()) learn(input.work, input.costs, now);

    BlockCosts costs = input.costs;
    for (std::size_t i = 0; i < weights_.size(); ++i) costs.values()[i] *= double(weights_[i]);
    const CostSums sums(costs);
    const std::vector<double> slow = all_relative_costs();
    const Partition fair = fair_with_room(input, sums, slow);
    const std::vector<TexelBox> then = boxes_of(fair, input.lattice);

    const double stay_ms = slowest(sums, now, slow), move_ms = slowest(sums, then, slow);
    double scatter = 0;
    for (const RelativeCost& relative_cost : relative_cost_) scatter += relative_cost.scatter() / double(ranks);
    const double gain = stay_ms - move_ms;
    const double cost = double(most_blocks_moved(input.lattice, now, then)) * input.ms_per_block;
    bool moves = false;
    if (gain > stay_ms * std::max(settings_.least_gain, scatter)) {
      lost_ms_ += gain;
      moves = lost_ms_ + settings_.horizon * gain > cost;
    } else {
      lost_ms_ = 0;
    }
    if (moves) lost_ms_ = 0;
    expect(sums, moves ? then : now);
    return moves ? fair : input.partition;
  }

 private:
  /// Updates relative costs and weights from the measurements of the last image.
  void learn(std::span<const RankWork> work, const BlockCosts& costs, const std::vector<TexelBox>& boxes) {
    double samples = 0, ms = 0;
    for (const RankWork& rank : work) {
      samples += double(rank.samples);
      ms += rank.ms;
    }
    if (samples <= 0) return;
    // Few samples say little about a rank's speed: some samples at the usual cost are added to them.
    constexpr double of_mean = 0.02;
    const double few = of_mean * samples / double(work.size());
    for (std::size_t rank = 0; rank < work.size(); ++rank) {
      RelativeCost& relative_cost = relative_cost_[rank];
      const double usual = relative_cost.known() ? relative_cost.value() : ms / samples;
      if (double(work[rank].samples) > few || !relative_cost.known())
        relative_cost.measure((work[rank].ms + few * usual) / (double(work[rank].samples) + few));
    }
    if (predicted_.size() != work.size()) return;
    for (std::size_t rank = 0; rank < work.size(); ++rank) {
      const double expected = predicted_[rank];
      if (expected <= 0) continue;
      // Half of the correction, as a factor (its square root).
      const double right = std::clamp(double(work[rank].samples) / expected, 1.0 / 16, 16.0);
      const auto factor = float(std::sqrt(right));
      const TexelBox cubes = costs.cubes_of(boxes[rank]);
      for (int z = cubes.low[2]; z < cubes.high[2]; ++z)
        for (int y = cubes.low[1]; y < cubes.high[1]; ++y)
          for (int x = cubes.low[0]; x < cubes.high[0]; ++x) {
            float& weight = weights_[costs.index({x, y, z})];
            weight = std::clamp(weight * factor, least_weight, most_weight);
          }
    }
  }

  std::vector<double> all_relative_costs() const {
    double sum = 0, known = 0;
    for (const RelativeCost& relative_cost : relative_cost_)
      if (relative_cost.known()) {
        sum += relative_cost.value();
        known += 1;
      }
    const double usual = known > 0 && sum > 0 ? sum / known : 1;
    std::vector<double> result;
    for (const RelativeCost& relative_cost : relative_cost_)
      result.push_back(relative_cost.known() && relative_cost.value() > 0 ? relative_cost.value() : usual);
    return result;
  }

  /// A rank that would hold more than it has room for counts as slower, so that the others share the rest
  /// fairly.
  static Partition fair_with_room(const BalanceInput& input, const CostSums& sums, std::vector<double> slow) {
    constexpr int attempts = 8;
    for (int attempt = 1;; ++attempt) {
      Partition fair = refined(fair_partition(input, sums, slow), input, sums, slow);
      if (input.most_blocks.empty()) return fair;
      const std::vector<TexelBox> boxes = boxes_of(fair, input.lattice);
      bool fits = true;
      for (std::size_t rank = 0; rank < boxes.size(); ++rank) {
        const double over =
            double(blocks_in(boxes[rank])) / double(std::max<std::size_t>(1, input.most_blocks[rank]));
        if (over <= 1) continue;
        slow[rank] *= over;
        fits = false;
      }
      if (fits) return fair;
      if (attempt == attempts) return with_room(input.partition, fair, input.lattice, input.most_blocks);
    }
  }

  static Partition fair_partition(const BalanceInput& input, const CostSums& sums,
                                  const std::vector<double>& slow) {
    Partition partition = input.partition;
    const int edge = input.costs.edge();
    walk_splits(partition, input.lattice, [&](std::size_t i, const TexelBox& box) {
      Partition::Split& split = partition.splits[i];
      const auto speed = [&](int child) {
        double sum = 0;
        for (const int rank : ranks_under(partition, child)) sum += 1 / slow[std::size_t(rank)];
        return sum;
      };
      const double low = speed(split.low), high = speed(split.high);
      int cut = split.cut;
      if (sums.within(box) > 0)
        if (const auto fair = volume::fair_cut(sums, box, split.axis, low / (low + high))) cut = *fair;
      split.cut = allowed_cut(partition, i, box, input.lattice, edge, cut);
    });
    return partition;
  }

  /// Moves planes by one more layer, one plane at a time, while that evens out the ranks' times: two sides of a
  /// split can have fair shares although neither can be divided fairly.
  static Partition refined(Partition partition, const BalanceInput& input, const CostSums& sums,
                           const std::vector<double>& slow) {
    constexpr int most_ranks = 64, rounds = 3;  // the time grows with the square of the ranks
    if (partition.ranks > most_ranks) return partition;
    const int edge = input.costs.edge();
    const double mean = sums.within(input.lattice) / double(slow.size());
    // A sum of 8th powers lies between maximum and sum of squares: the second slowest counts, too.
    const auto unevenness = [&](const Partition& of) {
      double sum = 0;
      const std::vector<TexelBox> boxes = boxes_of(of, input.lattice);
      for (std::size_t rank = 0; rank < boxes.size(); ++rank) {
        const double time = sums.within(boxes[rank]) * slow[rank] / (mean * slow[0]);
        const double square = time * time, fourth = square * square;
        sum += fourth * fourth;
      }
      return sum;
    };
    if (mean <= 0) return partition;
    double least = unevenness(partition);
    bool better = true;
    for (int round = 0; better && round < rounds; ++round) {
      better = false;
      for (std::size_t i = 0; i < partition.splits.size(); ++i)
        for (const int step : {-edge, edge}) {
          Partition candidate = partition;
          candidate.splits[i].cut += step;
          walk_splits(candidate, input.lattice, [&](std::size_t k, const TexelBox& box) {
            candidate.splits[k].cut =
                allowed_cut(candidate, k, box, input.lattice, edge, candidate.splits[k].cut);
          });
          const double sum = unevenness(candidate);
          constexpr double worth_it = 0.98;
          if (sum >= least * worth_it) continue;
          least = sum;
          partition = candidate;
          better = true;
        }
    }
    return partition;
  }

  static double slowest(const CostSums& sums, const std::vector<TexelBox>& boxes,
                        const std::vector<double>& slow) {
    double most = 0;
    for (std::size_t rank = 0; rank < boxes.size(); ++rank)
      most = std::max(most, sums.within(boxes[rank]) * slow[rank]);
    return most;
  }

  void expect(const CostSums& sums, const std::vector<TexelBox>& boxes) {
    predicted_.clear();
    for (const TexelBox& box : boxes) predicted_.push_back(sums.within(box));
  }

  static constexpr float least_weight = 1.0F / 64, most_weight = 64;

  PredictingSettings settings_;
  std::vector<RelativeCost> relative_cost_;
  std::vector<float> weights_;     // by cube
  std::vector<double> predicted_;  // by rank: samples expected in the image of the last decision
  double lost_ms_ = 0;             // by staying, since moving would have been faster
};

}  // namespace

std::unique_ptr<Balancer> predicting_balancer(const PredictingSettings& settings) {
  return std::make_unique<PredictingBalancer>(settings);
}

}  // namespace understudy::compositor
