// SPDX-License-Identifier: Apache-2.0
// Bricked storage of one rank's share of a volume.
//
// Blocks of 8^3 cells are stored with their 9^3 texels, so that the eight corners of any cell lie close
// together in one block and sampling needs neither border tests nor a neighbour (x 1.44 memory). All blocks of
// texels with the same value share one stored block: padding and air take no memory.
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

  /// Holds the blocks that intersect `owned_cells` (cell coordinates, half-open, inside the lattice; may be
  /// empty) or the volume's ghost layer around them. Throws std::invalid_argument.
  BrickStore(const VolumeDescription& volume, const TexelBox& owned_cells);

  /// The texels that a store with these cells needs; others need not be sent. Empty if there are no cells.
  static TexelBox texels_shown(const VolumeDescription& volume, const TexelBox& owned_cells);
  const TexelBox& texels_shown() const { return shown_; }

  /// Adds the texels of a slice range inside `stored`, which must cover at least texels_shown() in x and y.
  /// Each slice that is needed must be added once; ascending order needs the least memory. Throws
  /// std::invalid_argument when the slice range lies outside, is too narrow, was added before, or has the wrong
  /// size.
  void add_slices(const TexelBox& slice_range, std::span<const std::byte> texels);

  /// Call after the last slice range, before sampling. Throws std::invalid_argument naming a slice that is
  /// missing.
  void finish();

  /// Replaces the texels of a box inside `stored`, in a finished store, and appends the blocks that contain any
  /// of them to `changed`. Throws std::invalid_argument.
  void change(const TexelBox& box, std::span<const std::byte> texels, std::vector<std::size_t>& changed);
  bool finished() const { return finished_; }
  /// The blocks that contain a texel of `box`, as determined by change().
  std::vector<std::size_t> blocks_that_show(const TexelBox& box) const;

  /// From now on stores blocks where stores of other processes can read them. Call before any texels are added;
  /// a shared store must never be reshaped. Throws std::system_error.
  void share();
  /// The descriptor, in this process, of the shared memory; -1: none.
  int shared_descriptor() const { return shared_.descriptor(); }
  /// Makes the current contents of a finished shared store available to its readers.
  void publish();
  /// Call instead of adding texels, and again after each publish(): shows the blocks of a store with the same
  /// cells, whose descriptor is at `path`. That store must outlive the use of this one, and must not change
  /// meanwhile. Throws std::system_error and std::invalid_argument.
  void read_blocks_of(const std::string& path);

  /// A block's position, counted in blocks from the lattice's low corner.
  using BlockPlace = std::array<int, 3>;
  /// The block at `place`, which this finished store holds, in the form in which stores of one volume exchange
  /// blocks: its texels, or a single texel if all are equal.
  std::vector<std::byte> packed(const BlockPlace& place) const;
  /// Changes the owned cells of a finished store. Blocks that intersect them or the ghost layer around them are
  /// kept if already held; the others are obtained from `packed_block`. Throws std::invalid_argument, and
  /// leaves the store unchanged, for cells outside the lattice.
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

  /// Per block its 9^3 texels, x fastest, of the volume's texel type. Sixteen bytes may be read from the start
  /// of any cell edge along x; for u8, only from edges at the low side of a cell in y.
  std::span<const std::byte* const> block_data() const { return blocks_; }

  /// The range of values in a block, in units of the texel type (u8: 0..255), ignoring NaN; empty: low > high.
  struct Range {
    float low = 0;
    float high = 0;
  };
  /// Ranges of block `b`: one for scalar fields, four (RGBA) for colours. The border colour is included where
  /// the filter can reach it.
  std::span<const Range> ranges(std::size_t b) const { return {ranges_.data() + b * channels_, channels_}; }

  /// The border colour in units of the texel type.
  const Rgba& border() const { return border_; }

  /// Memory used by this store, in bytes.
  std::size_t bytes() const;
  /// Upper bound of bytes() for a store with these cells and any texels, including while they arrive.
  static std::size_t most_bytes(const VolumeDescription& volume, const TexelBox& owned_cells);

  /// Infinite and huge values of a float field are clamped to this magnitude, so that interpolation cannot
  /// overflow.
  static constexpr float largest_value = 4.2535296e37F;  // 2^125

 private:
  static constexpr std::size_t blocks_per_chunk = 256;  ///< unit of memory allocation

  /// The blocks of one layer (equal z) while its slices arrive: uncompressed, dense.
  struct Layer {
    std::vector<std::byte> texels;
    int slices_missing = block_row;
  };

  /// A lattice point of a block, and the texel at it.
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
  /// Per block along `axis`, the points whose texels lie in `box`.
  std::vector<std::vector<Point>> points_in(const TexelBox& box, int axis) const;
  template <typename Texel>
  void change_block(std::size_t block, const std::array<std::span<const Point>, 3>& points, const TexelBox& box,
                    const std::byte* texels);
  /// Makes `block` show these texels, in its own storage or that of an equal block. Release its storage first.
  template <typename Texel>
  void store_block(std::size_t block, const Texel* texels);
  /// Releases the storage of `block` for reuse.
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
  SharedBlocks shared_;                  // replaces chunks: created here, or mapped for reading
  std::size_t shared_used_ = 0;          // blocks used of it
  std::vector<std::byte*> free_blocks_;  // released by changes
  struct Shared {
    std::byte* place = nullptr;
    std::size_t users = 0;
  };
  std::unordered_map<std::uint32_t, Shared> constant_blocks_;  // by the bits of their value
  std::vector<bool> constant_;                                 // per block: whether it is in constant_blocks_
  std::vector<Layer> layers_;
  TexelBox shown_;
  std::vector<bool> slice_seen_;  // of the slices in shown_
  bool finished_ = false;
};

}  // namespace understudy::volume
