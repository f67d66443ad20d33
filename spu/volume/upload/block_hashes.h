// SPDX-License-Identifier: Apache-2.0
// What was sent of a volume, as one 64-bit hash per block: enough to tell which texels differ when the
// application uploads them all again, without keeping them. Two different blocks pass for equal once in 2^64.
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

  /// The smallest box of whole blocks around what of `box` is stored; may be empty.
  volume::TexelBox whole_blocks(const volume::TexelBox& box) const;

  /// Takes in the texels of a box, tightly packed, that ends on blocks' faces in x and y; along z a block's
  /// slices may come in several calls, in rising order. Returns boxes around the blocks whose last slice came
  /// and whose texels differ from those of last time; the first time all do.
  std::vector<volume::TexelBox> take(const volume::TexelBox& box, std::span<const std::byte> texels);

  /// Lowest and highest finite value, normalised, of a field of floats or of 16 bits; low > high when there is
  /// none, and for other types.
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
  std::vector<Block> arriving_;  ///< one layer of blocks, as far as its slices have come
};

}  // namespace understudy::spu
