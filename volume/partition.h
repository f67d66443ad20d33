// SPDX-License-Identifier: Apache-2.0
// Where a volume is cut, one convex box for each rank: a binary tree of split planes. kd_tree.h makes boxes and
// a visibility order of it. Planes lie on block faces wherever one lies inside the box that is cut.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace understudy::volume {

class CostSums;
struct TexelBox;
struct VolumeDescription;

/// Most ranks that are believed.
constexpr int max_ranks = 65536;

/// A value: equal partitions cut a volume alike on every rank.
struct Partition {
  struct Split {
    int axis = 0;
    int cut = 0;   ///< the first cell of the high side
    int low = -1;  ///< what lies below and above: another split, further on, or ~rank
    int high = -1;

    bool operator==(const Split&) const = default;
  };

  int ranks = 1;
  std::vector<Split> splits;  ///< the first one cuts all shown cells; none: one rank

  bool operator==(const Partition&) const = default;
};

/// The boxes of the ranks, which tile the shown cells; some may be empty. Throws std::invalid_argument when a
/// rank has no place in the tree or two, or a plane lies outside of what it cuts.
std::vector<TexelBox> boxes(const Partition& partition, const VolumeDescription& volume);

/// The box that each split cuts, in the order of the splits.
std::vector<TexelBox> cut_boxes(const Partition& partition, const TexelBox& cells);

/// How the members of a group divide a volume.
enum class PartitionMethod : std::uint8_t {
  blocks,   ///< by_blocks()
  factors,  ///< by_factors()
  cost,     ///< by_cost() once an image is asked for, and until then by_blocks()
};
/// Before any image is asked for.
Partition initial_partition(const VolumeDescription& volume, int ranks, PartitionMethod method);

/// Boxes with about as many blocks each: the longest axis is halved, in proportion to the ranks on either side.
Partition by_blocks(const VolumeDescription& volume, int ranks);

/// x y z = `ranks` boxes in rows and columns, with the least faces between them. (Magallon et al. 2001.)
Partition by_factors(const VolumeDescription& volume, int ranks);
std::array<int, 3> factors(const VolumeDescription& volume, int ranks);

/// Boxes that cost about the same: of the three axes the one is cut that divides the costs best, the longest of
/// those about equally good.
Partition by_cost(int ranks, const CostSums& costs);
/// The same; throws std::invalid_argument when the costs are those of another volume.
Partition by_cost(const VolumeDescription& volume, int ranks, const CostSums& costs);

/// Where across `axis` to cut `cells`, such that the low side's part of the costs is nearest to `share`: on the
/// face of a cube. Nothing if no such face lies inside.
std::optional<int> fair_cut(const CostSums& costs, const TexelBox& cells, int axis, double share);

}  // namespace understudy::volume
