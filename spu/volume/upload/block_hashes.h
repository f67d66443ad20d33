// SPDX-License-Identifier: Apache-2.0
// One 64-bit hash for each block that was sent of a volume: determines which texels differ when the application
// uploads all of them again, without keeping them. Two different blocks have equal hashes with probability
// 2^-64.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "volume/texel_box.h"
#include "volume/texel_type.h"

namespace understudy::spu {

class BlockHashes {
 public:
  static constexpr int edge = 16;  ///< texels of a block, fewer at the high ends

  BlockHashes() = default;
  BlockHashes(const volume::TexelBox& stored, volume::TexelType type);

  /// Returns the smallest box of whole blocks around the stored part of `box`; may be empty.
  volume::TexelBox whole_blocks(const volume::TexelBox& box) const;

  /// Takes the texels of a box, tightly packed, that ends on faces of blocks in x and y; along z, the slices of
  /// a block may come in several calls, in ascending order. Returns boxes around the blocks that are complete
  /// now, and whose texels differ from the previous ones; the first time all do.
  std::vector<volume::TexelBox> take(const volume::TexelBox& box, std::span<const std::byte> texels);

  /// Returns the lowest and highest finite value, normalised, of a field of floats or of 16 bits; low > high if
  /// there is none, and for other types.
  std::array<float, 2> range() const;

 private:
  struct Block {
    std::uint64_t hash = 0;
    std::array<float, 2> range{};
  };

  void take_slice(int z, const volume::TexelBox& box, const std::byte* slice);
  void compare_layer(int z, const volume::TexelBox& box, std::vector<volume::TexelBox>& changed);

  volume::TexelBox stored_;
  volume::TexelType type_{};
  std::array<std::size_t, 3> counts_{};
  std::vector<Block> blocks_;
  std::vector<bool> known_;      ///< per block
  std::vector<Block> arriving_;  ///< one layer of blocks, as far as its slices have arrived
};

}  // namespace understudy::spu
