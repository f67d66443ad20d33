// SPDX-License-Identifier: Apache-2.0
// The blocks that change ranks when the planes of a partition move.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "volume/description.h"
#include "volume/partition.h"

namespace understudy::compositor {

/// A box of blocks of 8^3 cells that rank `to` receives and rank `from` owned, counted in blocks from the
/// lattice's low corner.
struct BlockMove {
  int from = 0;
  int to = 0;
  volume::TexelBox blocks;
};

/// Returns the blocks that a rank with these cells keeps: those that meet them or the ghost layer around.
volume::TexelBox blocks_kept(const volume::VolumeDescription& volume, const volume::TexelBox& cells);

/// Returns the blocks whose lowest cell is one of `cells`.
volume::TexelBox blocks_owned(const volume::TexelBox& lattice, const volume::TexelBox& cells);

/// Lists every block that a rank keeps after the move but not before, once, with the rank that owned it. The
/// order is the same on all ranks.
std::vector<BlockMove> moves(const volume::VolumeDescription& volume, std::span<const volume::TexelBox> before,
                             std::span<const volume::TexelBox> after);

/// Returns how many blocks the busiest rank sends or receives, ghost layers excluded.
std::size_t most_blocks_moved(const volume::TexelBox& lattice, std::span<const volume::TexelBox> before,
                              std::span<const volume::TexelBox> after);

/// Returns `a` without `b`, as at most six boxes.
std::vector<volume::TexelBox> difference(const volume::TexelBox& a, const volume::TexelBox& b);

}  // namespace understudy::compositor
