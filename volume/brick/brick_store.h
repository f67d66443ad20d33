// Bricked storage of one rank's share of a volume.
//
// Blocks of 8^3 cells keep their 9^3 texels together, so that the eight corners of any cell lie close to each
// other in one block and sampling needs neither border tests nor a neighbour (x 1.44 memory). A block of
// equal texels shares one stored block with all others of the same value: padding and air cost no memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "volume/brick/cell_lattice.h"
#include "volume/request.h"

namespace understudy::volume {

/// Most blocks that one store holds (137e9 cells).
constexpr std::uint64_t max_blocks = std::uint64_t(1) << 28;

class BrickStore {
 public:
  static constexpr int block_cells = 8;
  static constexpr int block_row = block_cells + 1;          ///< texels from one y to the next
  static constexpr int block_slice = block_row * block_row;  ///< texels from one z to the next
  static constexpr int block_texels = block_row * block_slice;

  /// Holds the blocks that meet `owned_cells` (cell coordinates, half-open, inside the lattice; may be
  /// empty) or the volume's margin around them. Throws std::invalid_argument.
  BrickStore(const VolumeDescription& volume, const TexelBox& owned_cells);

  /// Texels of the slices [first_slice, first_slice + slices) of `stored` (absolute z), tightly packed, x
  /// fastest, the slab covering `stored` in x and y. Slabs come once each; in rising order they need the
  /// least memory. Throws std::invalid_argument when the slab lies outside `stored`, came before, or has the
  /// wrong size.
  void add_slices(int first_slice, int slices, std::span<const std::byte> texels);

  /// To be called after the last slab, before sampling. Throws std::invalid_argument naming a slice that is
  /// missing.
  void finish();
  bool finished() const { return finished_; }

  const VolumeDescription& description() const { return volume_; }
  const CellLattice& lattice() const { return lattice_; }
  const TexelBox& owned_cells() const { return owned_; }
  bool empty() const { return blocks_.empty(); }

  /// Blocks held: a box of blocks, x fastest. Block (0,0,0) begins at lattice cell 8 * first_block().
  const std::array<int, 3>& first_block() const { return first_block_; }
  const std::array<int, 3>& block_counts() const { return block_counts_; }
  std::size_t blocks() const { return blocks_.size(); }

  /// Per block its 9^3 texels, x fastest, of the volume's texel type. Sixteen bytes may be read from where any
  /// edge of a cell along x begins; of u8, from the lower edge of a slice only.
  std::span<const std::byte* const> block_data() const { return blocks_; }

  /// The values that occur in a block, in units of the texel type (u8: 0..255), NaN left out; none: low >
  /// high.
  struct Range {
    float low = 0;
    float high = 0;
  };
  /// Ranges of block `b`: one for scalar fields, four (RGBA) for colours. The border colour is included where
  /// the filter can reach it.
  std::span<const Range> ranges(std::size_t b) const { return {ranges_.data() + b * channels_, channels_}; }

  /// The border colour in units of the texel type.
  const Rgba& border() const { return border_; }

  /// Everything this store keeps, in bytes.
  std::size_t bytes() const;

  /// Infinite and huge values of a float field are brought into this range, so that no interpolation
  /// overflows.
  static constexpr float largest_value = 4.2535296e37F;  // 2^125

 private:
  /// The blocks of one block layer (equal z) while its slices arrive: uncompressed, dense.
  struct Layer {
    std::vector<std::byte> texels;
    int slices_missing = block_row;
  };

  void place_slice(int lattice_z, const std::byte* slice);
  template <typename Texel>
  void fill_layer_slice(Layer& layer, int z_in_block, const std::byte* slice);
  void complete_layer(int layer_index);
  template <typename Texel>
  void compact_layer(int layer_index);
  template <typename Texel>
  void add_ranges(std::size_t block, const Texel* texels);
  std::byte* allocate_block();

  VolumeDescription volume_;
  CellLattice lattice_;
  TexelBox owned_;
  std::array<int, 3> first_block_{};
  std::array<int, 3> block_counts_{};
  std::size_t channels_ = 1;
  std::size_t block_bytes_ = 0;
  Rgba border_{};

  std::vector<const std::byte*> blocks_;
  std::vector<Range> ranges_;
  std::vector<std::unique_ptr<std::byte[]>> chunks_;
  std::size_t chunk_used_ = 0;
  std::unordered_map<std::uint32_t, const std::byte*> constant_blocks_;  // by the bits of their value
  std::vector<Layer> layers_;
  std::vector<bool> slice_seen_;
  bool finished_ = false;
};

}  // namespace understudy::volume
