// SPDX-License-Identifier: Apache-2.0
// Queries on a partition's tree, for the balancers.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "volume/partition.h"
#include "volume/texel_box.h"

namespace understudy::compositor {

/// Returns the ranks under a child of a split. A child is another split, or ~rank.
std::vector<int> ranks_under(const volume::Partition& partition, int child);

/// Returns how many layers of blocks the ranks under a child need across each axis, so that each has some.
std::array<int, 3> layers_needed(const volume::Partition& partition, int child);

/// Returns the place nearest to `cut` at which both sides of split `split`, which cuts `box`, have the layers
/// that they need.
int allowed_cut(const volume::Partition& partition, std::size_t split, const volume::TexelBox& box,
                const volume::TexelBox& lattice, int edge, int cut);

/// Returns the cells of each rank, by rank.
std::vector<volume::TexelBox> boxes_of(const volume::Partition& partition, const volume::TexelBox& lattice);

/// Returns the number of blocks of 8^3 cells in a box, partial ones included.
std::size_t blocks_in(const volume::TexelBox& box);

/// Returns `next` if no rank would then hold more than its `most_blocks`. Otherwise moves the planes from `now`
/// towards `next` as far as all ranks have room. `most_blocks` is by rank; empty: no limit.
volume::Partition with_room(const volume::Partition& now, const volume::Partition& next,
                            const volume::TexelBox& lattice, std::span<const std::size_t> most_blocks);

/// Calls visit(split, box) for every split, with the box that it cuts. When `visit` moves planes, the boxes
/// further down follow.
template <class Visit>
void walk_splits(volume::Partition& partition, const volume::TexelBox& lattice, const Visit& visit) {
  std::vector<volume::TexelBox> cut(partition.splits.size(), lattice);
  for (std::size_t i = 0; i < cut.size(); ++i) {
    visit(i, cut[i]);
    const volume::Partition::Split& split = partition.splits[i];
    const auto axis = std::size_t(split.axis);
    if (split.low >= 0) {
      cut[std::size_t(split.low)] = cut[i];
      cut[std::size_t(split.low)].high[axis] = split.cut;
    }
    if (split.high >= 0) {
      cut[std::size_t(split.high)] = cut[i];
      cut[std::size_t(split.high)].low[axis] = split.cut;
    }
  }
}

}  // namespace understudy::compositor
