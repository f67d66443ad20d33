// SPDX-License-Identifier: Apache-2.0
// What changes hands when the planes of a partition move.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "volume/description.h"
#include "volume/partition.h"

namespace understudy::compositor {

/// Blocks of 8^3 cells that one rank comes to hold and another has owned: a box of them, counted from the
/// lattice's low corner.
struct BlockMove {
  int from = 0;
  int to = 0;
  volume::TexelBox blocks;
};

/// The blocks that a rank with these cells keeps: those that meet them or the volume's ghost layer around them.
volume::TexelBox blocks_kept(const volume::VolumeDescription& volume, const volume::TexelBox& cells);

/// The blocks whose lowest cell is one of these.
volume::TexelBox blocks_owned(const volume::TexelBox& lattice, const volume::TexelBox& cells);

/// Every block that a rank keeps after the move and not before, once, from the rank that owned it. In one order
/// on all ranks.
std::vector<BlockMove> moves(const volume::VolumeDescription& volume, std::span<const volume::TexelBox> before,
                             std::span<const volume::TexelBox> after);

/// The blocks that the busiest rank sends or receives. Ghost layers left out.
std::size_t most_blocks_moved(const volume::TexelBox& lattice, std::span<const volume::TexelBox> before,
                              std::span<const volume::TexelBox> after);

/// `a` without `b`, as at most six boxes.
std::vector<volume::TexelBox> difference(const volume::TexelBox& a, const volume::TexelBox& b);

}  // namespace understudy::compositor
