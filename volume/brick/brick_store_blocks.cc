// SPDX-License-Identifier: Apache-2.0
// Blocks sent to and received from other stores, when the cells of ranks change.
#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "volume/brick/brick_store.h"
#include "volume/texel_box.h"
#include "volume/texel_type.h"

namespace understudy::volume {

std::vector<std::byte> BrickStore::packed(const BlockPlace& place) const {
  std::size_t block = 0;
  for (int axis = 2; axis >= 0; --axis)
    block = block * std::size_t(block_counts_[axis]) + std::size_t(place[axis] - first_block_[axis]);
  const std::size_t texel = bytes_per_texel(volume_.type);
  const std::byte* from = blocks_[block];
  return {from, from + texel * (constant_[block] ? 1 : block_texels)};
}

void BrickStore::reshape(const TexelBox& owned_cells,
                         const std::function<std::vector<std::byte>(const BlockPlace&)>& packed_block) {
  if (!finished_) throw std::logic_error("the cells of a store change before all its texels have come");
  BrickStore other(volume_, owned_cells);  // provides the new geometry
  const std::array<int, 3> first = first_block_, counts = block_counts_;
  const auto held = [&](const BlockPlace& place) {
    for (std::size_t k = 0; k < 3; ++k)
      if (place[k] < first[k] || place[k] >= first[k] + counts[k]) return false;
    return true;
  };
  const auto place_of = [](std::size_t block, const BrickStore& store) {
    const auto nx = std::size_t(store.block_counts_[0]), ny = std::size_t(store.block_counts_[1]);
    return BlockPlace{store.first_block_[0] + int(block % nx), store.first_block_[1] + int(block / nx % ny),
                      store.first_block_[2] + int(block / (nx * ny))};
  };

  std::vector<bool> stays(blocks_.size());
  std::vector<std::size_t> missing;
  for (std::size_t b = 0; b < other.blocks_.size(); ++b) {
    const BlockPlace place = place_of(b, other);
    if (!held(place)) {
      missing.push_back(b);
      continue;
    }
    std::size_t here = 0;
    for (int axis = 2; axis >= 0; --axis)
      here = here * std::size_t(counts[axis]) + std::size_t(place[axis] - first[axis]);
    stays[here] = true;
    other.blocks_[b] = blocks_[here];
    other.constant_[b] = constant_[here];
    std::copy_n(ranges_.begin() + std::ptrdiff_t(here * channels_), channels_,
                other.ranges_.begin() + std::ptrdiff_t(b * channels_));
  }
  for (std::size_t b = 0; b < blocks_.size(); ++b)
    if (!stays[b]) give_up_block(b);

  owned_ = other.owned_;
  first_block_ = other.first_block_;
  block_counts_ = other.block_counts_;
  shown_ = other.shown_;
  blocks_ = std::move(other.blocks_);
  constant_ = std::move(other.constant_);
  ranges_ = std::move(other.ranges_);
  slice_seen_.assign(other.slice_seen_.size(), true);
  for (const std::size_t b : missing) unpack(b, packed_block(place_of(b, *this)));
}

}  // namespace understudy::volume
