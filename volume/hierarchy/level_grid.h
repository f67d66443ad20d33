// SPDX-License-Identifier: Apache-2.0
// The levels of a hierarchical volume and their blocks. Level 0 is the volume; level l + 1 has every second
// sample of level l along each axis, including the first. So its samples are a subset of the volume's own, and
// neighbouring blocks of one level agree where they meet. The coarsest level is one block.
#pragma once

#include <array>
#include <cstddef>

#include "volume/texel_box.h"

namespace understudy::volume {

/// Edge of a block, in samples of its level. Even.
constexpr int hierarchy_block_edge = 64;

using BlockPlace = std::array<int, 3>;

class LevelGrid {
 public:
  /// `size` of the volume: 1 to max_axis_texels along each axis.
  explicit LevelGrid(const std::array<int, 3>& size);

  int levels() const { return levels_; }
  int coarsest() const { return levels_ - 1; }
  /// In samples.
  std::array<int, 3> size(int level) const;
  /// In blocks.
  std::array<int, 3> blocks(int level) const;
  /// The samples of a block, in its level.
  TexelBox samples_of(int level, const BlockPlace& block) const;

  /// Blocks are numbered from the coarsest level on, x fastest in each level.
  std::size_t number_of(int level, const BlockPlace& block) const;
  std::size_t count() const { return first_of(-1); }
  /// The number of a level's first block; for level -1: the number of blocks.
  std::size_t first_of(int level) const;

 private:
  std::array<int, 3> size_;
  int levels_ = 1;
};

/// The blocks that contain samples of `box`, as a half-open box of places.
TexelBox blocks_around(const TexelBox& box);

/// The samples of the next level from which those of `box` are predicted.
TexelBox coarser_samples_around(const TexelBox& box, const std::array<int, 3>& coarser_size);

/// Calls `visit` for every place in a box of blocks, x fastest.
template <typename Visit>
void for_each_block(const TexelBox& blocks, Visit&& visit) {
  for (int z = blocks.low[2]; z < blocks.high[2]; ++z)
    for (int y = blocks.low[1]; y < blocks.high[1]; ++y)
      for (int x = blocks.low[0]; x < blocks.high[0]; ++x) visit(BlockPlace{x, y, z});
}

}  // namespace understudy::volume
