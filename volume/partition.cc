// SPDX-License-Identifier: Apache-2.0
#include "volume/partition.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "volume/block_costs.h"
#include "volume/cell_lattice.h"

namespace understudy::volume {

namespace {

int extent(const TexelBox& cells, int axis) {
  return cells.high[axis] - cells.low[axis];
}

int longest_axis(const TexelBox& cells) {
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (extent(cells, k) > extent(cells, axis)) axis = k;
  return axis;
}

/// Where to cut for `left` of `ranks`: on the block face nearest to the proportional share, or between any two
/// cells when no block face lies inside; a single cell is not cut.
int even_cut(const TexelBox& lattice, const TexelBox& cells, int axis, int left, int ranks) {
  constexpr int block = block_cells;
  const int length = extent(cells, axis);
  if (length < 2) return cells.high[axis];
  const int offset = cells.low[axis] - lattice.low[axis];
  const double fair = double(length) * left / ranks;
  const int lowest = (offset / block + 1) * block - offset;              // first block face inside
  const int highest = ((offset + length - 1) / block) * block - offset;  // last one
  if (lowest > highest) return cells.low[axis] + std::clamp(int(std::lround(fair)), 1, length - 1);
  const int nearest = int(std::lround((offset + fair) / block)) * block - offset;
  return cells.low[axis] + std::clamp(nearest, lowest, highest);
}

/// A cut of a box, and the number of ranks on its low side.
struct Cut {
  int axis = 0;
  int at = 0;
  int left_ranks = 0;
};

void check_ranks(int ranks) {
  if (ranks < 1 || ranks > max_ranks)
    throw std::invalid_argument(
        fmt::format("a volume cannot be divided among {} ranks (1 to {} are possible)", ranks, max_ranks));
}

/// Cuts until every rank has its box; `choose` returns the cut for a box and its number of ranks.
template <class Choose>
int divide(Partition& partition, const TexelBox& cells, int first_rank, int ranks, const Choose& choose) {
  if (ranks == 1) return ~first_rank;
  const Cut cut = choose(cells, first_rank, ranks);
  const auto index = partition.splits.size();
  partition.splits.push_back({cut.axis, cut.at, 0, 0});
  TexelBox low = cells, high = cells;
  low.high[cut.axis] = high.low[cut.axis] = cut.at;
  const int low_child = divide(partition, low, first_rank, cut.left_ranks, choose);
  const int high_child = divide(partition, high, first_rank + cut.left_ranks, ranks - cut.left_ranks, choose);
  partition.splits[index].low = low_child;
  partition.splits[index].high = high_child;
  return int(index);
}

template <class Choose>
Partition divided(const TexelBox& cells, int ranks, const Choose& choose) {
  check_ranks(ranks);
  Partition partition;
  partition.ranks = ranks;
  divide(partition, cells, 0, ranks, choose);
  return partition;
}

}  // namespace

std::vector<TexelBox> cut_boxes(const Partition& partition, const TexelBox& cells) {
  std::vector<TexelBox> cut(partition.splits.size(), cells);
  for (std::size_t i = 0; i < cut.size(); ++i) {
    const Partition::Split& split = partition.splits[i];
    for (const bool high : {false, true}) {
      const int child = high ? split.high : split.low;
      if (child < 0) continue;
      TexelBox& part = cut[std::size_t(child)];
      part = cut[i];
      (high ? part.low : part.high)[split.axis] = split.cut;
    }
  }
  return cut;
}

std::vector<TexelBox> boxes(const Partition& partition, const VolumeDescription& volume) {
  check_ranks(partition.ranks);
  const auto splits = int(partition.splits.size());
  const auto wrong = [&](const char* what) {
    return std::invalid_argument(
        fmt::format("a partition of {} splits for {} ranks: {}", splits, partition.ranks, what));
  };
  if (splits != partition.ranks - 1) throw wrong("there must be one split fewer than ranks");
  std::vector<bool> placed(static_cast<std::size_t>(partition.ranks));
  std::vector<bool> reached(partition.splits.size());
  for (int i = 0; i < splits; ++i)
    for (const int child : {partition.splits[std::size_t(i)].low, partition.splits[std::size_t(i)].high}) {
      if (child < 0 ? ~child >= partition.ranks : child <= i || child >= splits)
        throw wrong("a split has something under it that cannot be there");
      auto seen = child < 0 ? placed.begin() + ~child : reached.begin() + child;
      if (*seen) throw wrong("a part has two places");
      *seen = true;
    }

  const TexelBox shown = shown_cells(volume);
  const std::vector<TexelBox> cut = cut_boxes(partition, shown);
  std::vector<TexelBox> result(std::size_t(partition.ranks), shown);
  for (std::size_t i = 0; i < cut.size(); ++i) {
    const Partition::Split& split = partition.splits[i];
    if (split.axis < 0 || split.axis > 2 || split.cut < cut[i].low[split.axis] ||
        split.cut > cut[i].high[split.axis])
      throw wrong("a plane lies outside of the box that it cuts");
    for (const bool high : {false, true}) {
      const int child = high ? split.high : split.low;
      if (child >= 0) continue;
      const int number = ~child;
      TexelBox& part = result[std::size_t(number)];
      part = cut[i];
      (high ? part.low : part.high)[split.axis] = split.cut;
    }
  }
  return result;
}

Partition initial_partition(const VolumeDescription& volume, int ranks, PartitionMethod method) {
  return method == PartitionMethod::factors ? by_factors(volume, ranks) : by_blocks(volume, ranks);
}

Partition by_blocks(const VolumeDescription& volume, int ranks) {
  const TexelBox lattice = cell_lattice(volume).box();
  return divided(shown_cells(volume), ranks, [&](const TexelBox& cells, int, int here) {
    const int axis = longest_axis(cells);
    return Cut{axis, even_cut(lattice, cells, axis, here / 2, here), here / 2};
  });
}

std::array<int, 3> factors(const VolumeDescription& volume, int ranks) {
  check_ranks(ranks);
  const TexelBox shown = shown_cells(volume);
  std::array<int, 3> best{};
  double least = std::numeric_limits<double>::infinity();
  for (int x = 1; x <= ranks; ++x) {
    if (ranks % x != 0) continue;
    for (int y = 1; y <= ranks / x; ++y) {
      if (ranks / x % y != 0) continue;
      const std::array<int, 3> candidate{x, y, ranks / x / y};
      double faces = 0;  // in faces of the volume, weighted by their areas
      for (int k = 0; k < 3; ++k) faces += double(candidate[k] - 1) / extent(shown, k);
      if (faces < least) {
        least = faces;
        best = candidate;
      }
    }
  }
  return best;
}

Partition by_factors(const VolumeDescription& volume, int ranks) {
  const TexelBox lattice = cell_lattice(volume).box();
  const std::array<int, 3> parts = factors(volume, ranks);
  // x is cut first, then y; so a box's number of ranks tells how far it has been cut.
  const int slice_segment = parts[1] * parts[2];
  return divided(shown_cells(volume), ranks, [&](const TexelBox& cells, int, int here) {
    const int axis = here > slice_segment ? 0 : here > parts[2] ? 1 : 2;
    const int unit = axis == 0 ? slice_segment : axis == 1 ? parts[2] : 1;
    const int left = here / unit / 2;
    return Cut{axis, even_cut(lattice, cells, axis, left, here / unit), left * unit};
  });
}

std::optional<int> fair_cut(const CostSums& costs, const TexelBox& cells, int axis, double share) {
  const int edge = costs.costs().edge(), origin = costs.costs().lattice().low[axis];
  const int first = (cells.low[axis] - origin) / edge + 1;
  const int last = (cells.high[axis] - 1 - origin) / edge;
  if (first > last) return std::nullopt;
  const double target = share * costs.within(cells);
  const auto low_side = [&](int face) {
    TexelBox low = cells;
    low.high[axis] = origin + face * edge;
    return costs.within(low);
  };
  // Costs are not negative, so the cost of the low side increases with the face.
  int below = first, above = last;
  while (below < above) {
    const int middle = below + (above - below) / 2;
    if (low_side(middle) < target)
      below = middle + 1;
    else
      above = middle;
  }
  if (below > first && target - low_side(below - 1) <= low_side(below) - target) --below;
  return origin + below * edge;
}

Partition by_cost(const VolumeDescription& volume, int ranks, const CostSums& costs) {
  if (!(shown_cells(volume) == costs.costs().lattice()))
    throw std::invalid_argument("the costs are those of another volume: make them for this volume's lattice");
  return by_cost(ranks, costs);
}

Partition by_cost(int ranks, const CostSums& costs) {
  const TexelBox& lattice = costs.costs().lattice();
  return divided(lattice, ranks, [&](const TexelBox& cells, int, int here) {
    const int left = here / 2;
    const double all = costs.within(cells);
    // For each axis, the relative excess of the costlier side over its share, for the best cut.
    std::array<double, 3> excess{};
    std::array<int, 3> at{};
    for (int axis = 0; axis < 3; ++axis) {
      const std::optional<int> cut = fair_cut(costs, cells, axis, double(left) / here);
      excess[axis] = cut && all > 0 ? 0 : std::numeric_limits<double>::infinity();
      at[axis] = cut.value_or(0);
      if (!cut || !(all > 0)) continue;
      TexelBox low = cells;
      low.high[axis] = *cut;
      const double part = costs.within(low);
      excess[axis] = std::max(part * here / left, (all - part) * here / (here - left)) / all - 1;
    }
    const double best = *std::ranges::min_element(excess);
    if (!std::isfinite(best)) {
      const int axis = longest_axis(cells);
      return Cut{axis, even_cut(lattice, cells, axis, left, here), left};
    }
    constexpr double about_equal = 0.05;
    int axis = -1;
    for (int k = 0; k < 3; ++k)
      if (excess[k] <= best + about_equal && (axis < 0 || extent(cells, k) > extent(cells, axis))) axis = k;
    return Cut{axis, at[axis], left};
  });
}

}  // namespace understudy::volume
