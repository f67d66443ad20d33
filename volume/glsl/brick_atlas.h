// SPDX-License-Identifier: Apache-2.0
// Some bricks of a BrickStore, as many as memory allows, side by side in one 3-D texture. Each has all texels
// of its cells' corners, so that a filter inside it needs no neighbour. Bricks come when they are asked for;
// those that were not asked for the longest make room.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "volume/brick/brick_store.h"
#include "volume/brick_grid.h"
#include "volume/glsl/device.h"
#include "volume/glsl/texture.h"

namespace understudy::volume::glsl {

class BrickAtlas {
 public:
  /// Takes what it needs of what is left of the device's memory. Wants the device to be current, as all
  /// functions do. Throws NotSupported where that is less than one brick.
  BrickAtlas(Device& device, const BrickStore& store, int brick_cells);

  /// The bricks of all blocks held.
  const BrickGrid& grid() const { return grid_; }
  /// How many bricks can be resident at a time.
  std::size_t slots() const { return brick_in_.size(); }

  /// Brings these bricks in, no more than slots(). Throws NotSupported when one has a texel that is not a
  /// number.
  void make_resident(std::span<const std::size_t> bricks);
  /// Blocks of the store that show other texels: the resident bricks among theirs are brought in again.
  void blocks_changed(std::span<const std::size_t> blocks);

  GLuint texels() const { return texels_.name(); }
  /// Of the texture, in texels.
  const std::array<int, 3>& size() const { return size_; }
  /// A texel per brick: where in the atlas it is, in slots along each axis, and whether it is there.
  GLuint pages() const { return pages_.name(); }

  /// Since the beginning: bricks brought in, and bricks that made room.
  std::uint64_t uploads() const { return uploads_; }
  std::uint64_t evictions() const { return evictions_; }

 private:
  static constexpr std::size_t none = ~std::size_t(0);

  int row() const { return grid_.edge + 1; }
  std::array<int, 3> place_of(std::size_t slot) const;
  void allocate_slots();
  void upload(std::size_t brick);
  void upload_pages();

  Device& device_;
  const BrickStore& store_;
  BrickGrid grid_;
  std::optional<TextureMemory::Part> memory_;
  Texture texels_, pages_;
  std::array<int, 3> size_{}, slots_along_{};
  std::vector<std::size_t> slot_of_;   ///< per brick
  std::vector<std::size_t> brick_in_;  ///< per slot
  std::vector<std::uint64_t> asked_;   ///< per slot: when its brick was asked for
  bool pages_changed_ = false;         ///< and the texture of pages does not tell yet
  std::uint64_t clock_ = 0;
  std::vector<std::byte> remote_;  ///< the texels of one brick
  std::uint64_t uploads_ = 0, evictions_ = 0;
};

}  // namespace understudy::volume::glsl
