// SPDX-License-Identifier: Apache-2.0
// Some bricks of a BrickStore, as many as memory allows, side by side in one 3D texture. Each contains all
// corner texels of its cells, so that filtering inside it needs no neighbour. Bricks are uploaded on request
// and replace the least recently requested ones.
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
  /// Reserves what it needs of the device's remaining memory. Like all functions, requires the device to be
  /// current. Throws NoTextureMemory if not even one brick fits.
  BrickAtlas(Device& device, const BrickStore& store, int brick_cells);

  /// The bricks of all blocks held.
  const BrickGrid& grid() const { return grid_; }
  /// How many bricks can be resident at a time.
  std::size_t slots() const { return brick_in_.size(); }

  /// Makes these bricks resident, at most slots() of them. Throws NotSupported when one has a NaN texel.
  void make_resident(std::span<const std::size_t> bricks);
  /// The texels of these blocks of the store have changed: uploads the affected resident bricks again.
  void blocks_changed(std::span<const std::size_t> blocks);

  GLuint texels() const { return texels_.name(); }
  /// Size of the texture, in texels.
  const std::array<int, 3>& size() const { return size_; }
  /// A texture with one texel per brick: its slot in the atlas along each axis, and whether it is resident.
  GLuint pages() const { return pages_.name(); }

  /// Bricks uploaded and bricks replaced since the beginning.
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
  std::vector<std::uint64_t> asked_;   ///< per slot: when its brick was last requested
  bool pages_changed_ = false;         ///< and the page texture is not up to date
  std::uint64_t clock_ = 0;
  std::vector<std::byte> remote_;  ///< the texels of one brick
  std::uint64_t uploads_ = 0, evictions_ = 0;
};

}  // namespace understudy::volume::glsl
