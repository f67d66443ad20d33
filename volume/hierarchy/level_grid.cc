// SPDX-License-Identifier: Apache-2.0
#include "volume/hierarchy/level_grid.h"

#include <algorithm>

namespace understudy::volume {

LevelGrid::LevelGrid(const std::array<int, 3>& size) : size_(size) {
  while (std::ranges::max(this->size(levels_ - 1)) > hierarchy_block_edge) ++levels_;
}

std::array<int, 3> LevelGrid::size(int level) const {
  std::array<int, 3> samples{};
  for (std::size_t k = 0; k < 3; ++k) samples[k] = ((size_[k] - 1) >> level) + 1;
  return samples;
}

std::array<int, 3> LevelGrid::blocks(int level) const {
  std::array<int, 3> blocks = size(level);
  for (int& n : blocks) n = (n + hierarchy_block_edge - 1) / hierarchy_block_edge;
  return blocks;
}

TexelBox LevelGrid::samples_of(int level, const BlockPlace& block) const {
  const std::array<int, 3> end = size(level);
  TexelBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.low[k] = block[k] * hierarchy_block_edge;
    box.high[k] = std::min(box.low[k] + hierarchy_block_edge, end[k]);
  }
  return box;
}

std::size_t LevelGrid::number_of(int level, const BlockPlace& block) const {
  const std::array<int, 3> n = blocks(level);
  const auto [x, y, z] = block;
  return first_of(level) + (std::size_t(z) * std::size_t(n[1]) + std::size_t(y)) * std::size_t(n[0]) +
         std::size_t(x);
}

std::size_t LevelGrid::first_of(int level) const {
  std::size_t before = 0;
  for (int coarser = coarsest(); coarser > level; --coarser) {
    const std::array<int, 3> n = blocks(coarser);
    before += std::size_t(n[0]) * std::size_t(n[1]) * std::size_t(n[2]);
  }
  return before;
}

TexelBox blocks_around(const TexelBox& box) {
  TexelBox blocks;
  for (std::size_t k = 0; k < 3; ++k) {
    blocks.low[k] = box.low[k] / hierarchy_block_edge;
    blocks.high[k] = (box.high[k] + hierarchy_block_edge - 1) / hierarchy_block_edge;
  }
  return blocks;
}

TexelBox coarser_samples_around(const TexelBox& box, const std::array<int, 3>& coarser_size) {
  TexelBox coarser;
  for (std::size_t k = 0; k < 3; ++k) {
    coarser.low[k] = box.low[k] / 2;
    coarser.high[k] = std::min((box.high[k] + 1) / 2 + 1, coarser_size[k]);
  }
  return coarser;
}

}  // namespace understudy::volume
