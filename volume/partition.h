// SPDX-License-Identifier: Apache-2.0
// How a volume is partitioned into one convex box per rank: a binary tree of split planes, from which kd_tree.h
// derives boxes and a visibility order. Planes lie on block faces wherever a block face lies inside the box to
// be cut.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace understudy::volume {

class CostSums;
struct TexelBox;
struct VolumeDescription;

/// Most ranks that are accepted.
constexpr int max_ranks = 65536;

/// A value type: equal partitions cut a volume identically on every rank.
struct Partition {
  struct Split {
    int axis = 0;
    int cut = 0;   ///< first cell of the high side
    int low = -1;  ///< children: the index of a later split, or ~rank
    int high = -1;

    bool operator==(const Split&) const = default;
  };

  int ranks = 1;
  std::vector<Split> splits;  ///< the first one cuts all shown cells; empty: one rank

  bool operator==(const Partition&) const = default;
};

/// The boxes of the ranks, which tile the shown cells; some may be empty. Throws std::invalid_argument when a
/// rank occurs in the tree not exactly once, or a plane lies outside the box that it cuts.
std::vector<TexelBox> boxes(const Partition& partition, const VolumeDescription& volume);

/// The box that each split cuts, in the order of the splits.
std::vector<TexelBox> cut_boxes(const Partition& partition, const TexelBox& cells);

/// How a volume is divided among the members of a group.
enum class PartitionMethod : std::uint8_t {
  blocks,   ///< by_blocks()
  factors,  ///< by_factors()
  cost,     ///< by_cost() from the first image request on, by_blocks() before
};
/// The partition before the first image is requested.
Partition initial_partition(const VolumeDescription& volume, int ranks, PartitionMethod method);

/// Boxes with about equally many blocks: bisects the longest axis, in proportion to the ranks on either side.
Partition by_blocks(const VolumeDescription& volume, int ranks);

/// x y z = `ranks` boxes in rows and columns, with the least area of faces between them. (Magallon et al.
/// 2001.)
Partition by_factors(const VolumeDescription& volume, int ranks);
std::array<int, 3> factors(const VolumeDescription& volume, int ranks);

/// Boxes of about equal cost: cuts the axis that divides the costs best, and of about equally good ones the
/// longest.
Partition by_cost(int ranks, const CostSums& costs);
/// The same; throws std::invalid_argument when the costs belong to another volume.
Partition by_cost(const VolumeDescription& volume, int ranks, const CostSums& costs);

/// The cut of `cells` across `axis`, on the face of a cube, at which the low side's part of the costs is
/// nearest to `share`. Empty if no such face lies inside.
std::optional<int> fair_cut(const CostSums& costs, const TexelBox& cells, int axis, double share);

}  // namespace understudy::volume
