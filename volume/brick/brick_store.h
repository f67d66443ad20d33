// SPDX-License-Identifier: Apache-2.0
// Bricked storage of one rank's share of a volume.
//
// Blocks of 8^3 cells keep their 9^3 texels together, so that the eight corners of any cell lie close to each
// other in one block and sampling needs neither border tests nor a neighbour (x 1.44 memory). A block of
// equal texels shares one stored block with all others of the same value: padding and air cost no memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "volume/brick/shared_blocks.h"
#include "volume/cell_lattice.h"
#include "volume/description.h"

namespace understudy::volume {

/// Most blocks that one store holds (137e9 cells).
constexpr std::uint64_t max_blocks = std::uint64_t(1) << 28;

class BrickStore {
 public:
  static constexpr int block_cells = volume::block_cells;
  static constexpr int block_row = block_cells + 1;          ///< texels from one y to the next
  static constexpr int block_slice = block_row * block_row;  ///< texels from one z to the next
  static constexpr int block_texels = block_row * block_slice;

  /// Holds the blocks that meet `owned_cells` (cell coordinates, half-open, inside the lattice; may be
  /// empty) or the volume's ghost layer around them. Throws std::invalid_argument.
  BrickStore(const VolumeDescription& volume, const TexelBox& owned_cells);

  /// The texels that a store with these cells shows: no others need come. Empty where there are no cells.
  static TexelBox texels_shown(const VolumeDescription& volume, const TexelBox& owned_cells);
  const TexelBox& texels_shown() const { return shown_; }

  /// Texels of a slice range inside `stored`, which in x and y covers at least texels_shown(). Each slice that
  /// is shown comes once; in rising order they need the least memory. Throws std::invalid_argument when the
  /// slice range lies outside, is too narrow, came before, or has the wrong size.
  void add_slices(const TexelBox& slice_range, std::span<const std::byte> texels);

  /// To be called after the last slice range, before sampling. Throws std::invalid_argument naming a slice that
  /// is missing.
  void finish();

  /// Other texels for a box inside `stored`, of a finished store. Throws std::invalid_argument. Adds the blocks
  /// that show one of them to `changed`.
  void change(const TexelBox& box, std::span<const std::byte> texels, std::vector<std::size_t>& changed);
  bool finished() const { return finished_; }
  /// The blocks that show a texel of `box`, as change() finds them.
  std::vector<std::size_t> blocks_that_show(const TexelBox& box) const;

  /// Keeps blocks from now on where stores of other processes can read them. Before any texels; the store is
  /// never reshaped then. Throws std::system_error.
  void share();
  /// The descriptor of the memory that is shared, of this process; -1: there is none.
  int shared_descriptor() const { return shared_.descriptor(); }
  /// Of a shared store that is finished: its readers may read what it holds now.
  void publish();
  /// Instead of texels, and again after each publish(): shows the blocks of a store with the same cells, whose
  /// descriptor is at `path`. That store outlives this one's use, and does not change meanwhile. Throws
  /// std::system_error and std::invalid_argument.
  void read_blocks_of(const std::string& path);

  /// A block's place, counted in blocks from the lattice's low corner.
  using BlockPlace = std::array<int, 3>;
  /// Block `place`, which this finished store holds, as it travels between stores of one volume: its texels, or
  /// the one that all of them are.
  std::vector<std::byte> packed(const BlockPlace& place) const;
  /// Other cells from now on, of a finished store. Blocks that meet them or the ghost layer around them stay
  /// where they are held already; the others come from `packed_block`. Throws std::invalid_argument, with the
  /// store as it was, for cells outside the lattice.
  void reshape(const TexelBox& owned_cells,
               const std::function<std::vector<std::byte>(const BlockPlace&)>& packed_block);

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
  /// No store with these cells ever keeps more, whatever its texels, while they come included.
  static std::size_t most_bytes(const VolumeDescription& volume, const TexelBox& owned_cells);

  /// Infinite and huge values of a float field are brought into this range, so that no interpolation
  /// overflows.
  static constexpr float largest_value = 4.2535296e37F;  // 2^125

 private:
  static constexpr std::size_t blocks_per_chunk = 256;  ///< of memory that is taken at once

  /// The blocks of one block layer (equal z) while its slices arrive: uncompressed, dense.
  struct Layer {
    std::vector<std::byte> texels;
    int slices_missing = block_row;
  };

  /// A lattice point of a block, and the texel behind it.
  struct Point {
    int in_block = 0;
    int texel = 0;
  };

  void check_size(const TexelBox& box, std::size_t bytes) const;
  void place_slice(int lattice_z, const TexelBox& slice_range, const std::byte* slice);
  template <typename Texel>
  void fill_layer_slice(Layer& layer, int z_in_block, const TexelBox& slice_range, const std::byte* slice);
  void complete_layer(int layer_index);
  template <typename Texel>
  void compact_layer(int layer_index);
  template <typename Texel>
  void add_ranges(std::size_t block, const Texel* texels);
  /// Per block along `axis` the points whose texels lie in `box`.
  std::vector<std::vector<Point>> points_in(const TexelBox& box, int axis) const;
  template <typename Texel>
  void change_block(std::size_t block, const std::array<std::span<const Point>, 3>& points, const TexelBox& box,
                    const std::byte* texels);
  /// Makes `block` show these texels, its own or those of an equal block. What it had is given up before.
  template <typename Texel>
  void store_block(std::size_t block, const Texel* texels);
  /// What it had may be overwritten.
  template <typename Texel>
  void give_up_block(std::size_t block);
  void give_up_block(std::size_t block);
  template <typename Texel>
  void unpack(std::size_t block, std::span<const std::byte> packed);
  void unpack(std::size_t block, std::span<const std::byte> packed);
  /// Calls a generic lambda with one texel of the volume's type.
  template <class Call>
  void with_texel(Call call) const;
  std::byte* allocate_block();
  std::byte* allocate_shared_block();
  std::size_t shared_ranges_at() const;
  std::size_t shared_blocks_at() const;
  std::size_t shared_bytes() const;

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
  SharedBlocks shared_;                  // instead of chunks: made here, or read
  std::size_t shared_used_ = 0;          // blocks of it
  std::vector<std::byte*> free_blocks_;  // given up by changes
  struct Shared {
    std::byte* place = nullptr;
    std::size_t users = 0;
  };
  std::unordered_map<std::uint32_t, Shared> constant_blocks_;  // by the bits of their value
  std::vector<bool> constant_;                                 // per block: its place is a shared one
  std::vector<Layer> layers_;
  TexelBox shown_;
  std::vector<bool> slice_seen_;  // of those that are shown
  bool finished_ = false;
};

}  // namespace understudy::volume
