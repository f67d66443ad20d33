// SPDX-License-Identifier: Apache-2.0
#include "volume/glsl/brick_atlas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "volume/glsl/brick_size.h"
#include "volume/glsl/texel_format.h"
#include "volume/texel_type.h"

namespace understudy::volume::glsl {

namespace {

constexpr int cells = BrickStore::block_cells;

BrickGrid grid_of(const BrickStore& store, int edge) {
  std::array<int, 3> first{}, end{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int lowest = store.lattice().origin[axis];
    first[axis] = lowest + store.first_block()[axis] * cells;
    end[axis] =
        std::min(first[axis] + store.block_counts()[axis] * cells, lowest + store.lattice().cells[axis]);
  }
  return BrickGrid::covering(first, end, edge);
}

/// Arranges as many slots as possible, at most `most` and at most `longest` along an axis; nearly a cube.
std::array<int, 3> arrange(std::uint64_t most, int longest) {
  std::array<int, 3> best{1, 1, 1};
  std::uint64_t held = 1;
  for (int x = 1; x <= longest && std::uint64_t(x) * std::uint64_t(x) * std::uint64_t(x) <= most; ++x)
    for (int y = x; y <= longest && std::uint64_t(x) * std::uint64_t(y) * std::uint64_t(y) <= most; ++y) {
      const auto face = std::uint64_t(x) * std::uint64_t(y);
      const auto z = int(std::min(most / face, std::uint64_t(longest)));
      // Later arrangements are closer to a cube.
      if (face * std::uint64_t(z) < held) continue;
      held = face * std::uint64_t(z);
      best = {x, y, z};
    }
  return best;
}

}  // namespace

BrickAtlas::BrickAtlas(Device& device, const BrickStore& store, int brick_cells)
    : device_(device),
      store_(store),
      grid_(grid_of(store, brick_cells)),
      texels_(device.gl()),
      pages_(device.gl()),
      slot_of_(grid_.bricks(), none) {
  const Functions& gl = device.gl();
  allocate_slots();
  const auto slots = std::size_t(slots_along_[0]) * std::size_t(slots_along_[1]) * std::size_t(slots_along_[2]);
  brick_in_.assign(slots, none);
  asked_.assign(slots, 0);
  gl.BindTexture(GL_TEXTURE_3D, pages_.name());
  for (const GLenum when : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    gl.TexParameteri(GL_TEXTURE_3D, when, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAX_LEVEL, 0);
  upload_pages();
}

void BrickAtlas::allocate_slots() {
  const TexelFormat format = format_of(store_.description().type);
  const std::uint64_t brick_bytes =
      std::uint64_t(row()) * std::uint64_t(row()) * std::uint64_t(row()) * format.bytes;
  const int longest = std::min(device_.max_volume_edge() / row(), 255);  // pages hold bytes
  const TextureMemory& memory = device_.texture_memory();
  std::uint64_t most = std::min(memory.left() / brick_bytes, std::uint64_t(grid_.bricks()));
  if (most == 0 || longest == 0)
    throw NoTextureMemory(
        fmt::format("{} of {} bytes of the GPU's memory are left, and one brick of the volume takes {}: give "
                    "more with --gpu-memory",
                    memory.left(), memory.bytes(), brick_bytes));
  remote_.resize(brick_bytes);
  for (;; most /= 2) {
    slots_along_ = arrange(most, longest);
    std::uint64_t bytes = brick_bytes;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      size_[axis] = slots_along_[axis] * row();
      bytes *= std::uint64_t(slots_along_[axis]);
    }
    device_.gl().BindTexture(GL_TEXTURE_3D, texels_.name());
    allocate(device_.gl(), format, size_);
    try {
      device_.check("making a texture for bricks");
    } catch (const OutOfMemory&) {
      // The reported free memory was wrong, or one texture cannot have all of it.
      if (most == 1) throw;
      continue;
    }
    memory_.emplace(device_.texture_memory(), bytes);
    return;
  }
}

std::array<int, 3> BrickAtlas::place_of(std::size_t slot) const {
  const auto along = std::size_t(slots_along_[0]), rows = std::size_t(slots_along_[1]);
  return {int(slot % along), int(slot / along % rows), int(slot / along / rows)};
}

void BrickAtlas::make_resident(std::span<const std::size_t> bricks) {
  if (bricks.size() > slots()) throw std::logic_error("more bricks at once than there are slots");
  ++clock_;
  std::vector<std::size_t> missing;
  for (const std::size_t brick : bricks) {
    if (slot_of_[brick] == none)
      missing.push_back(brick);
    else
      asked_[slot_of_[brick]] = clock_;
  }
  if (missing.empty() && !pages_changed_) return;
  pages_changed_ = true;
  std::vector<std::size_t> free;
  for (std::size_t slot = 0; slot < slots(); ++slot)
    if (asked_[slot] != clock_) free.push_back(slot);
  std::stable_sort(free.begin(), free.end(),
                   [&](std::size_t a, std::size_t b) { return asked_[a] < asked_[b]; });
  for (std::size_t i = 0; i < missing.size(); ++i) {
    const std::size_t slot = free[i];
    if (brick_in_[slot] != none) {
      slot_of_[brick_in_[slot]] = none;
      brick_in_[slot] = none;
      ++evictions_;
    }
    slot_of_[missing[i]] = slot;
    try {
      upload(missing[i]);
    } catch (...) {
      slot_of_[missing[i]] = none;
      throw;
    }
    brick_in_[slot] = missing[i];
    asked_[slot] = clock_;
  }
  upload_pages();
  pages_changed_ = false;
  device_.check("bringing bricks in");
}

void BrickAtlas::blocks_changed(std::span<const std::size_t> blocks) {
  const auto& counts = store_.block_counts();
  const auto blocks_along = std::size_t(grid_.edge / cells);
  std::vector<std::size_t> changed;
  for (const std::size_t block : blocks) {
    const auto nx = std::size_t(counts[0]), ny = std::size_t(counts[1]);
    const std::size_t x = block % nx / blocks_along, y = block / nx % ny / blocks_along,
                      z = block / nx / ny / blocks_along;
    const std::size_t brick = (z * std::size_t(grid_.counts[1]) + y) * std::size_t(grid_.counts[0]) + x;
    if (slot_of_[brick] != none) changed.push_back(brick);
  }
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  for (const std::size_t brick : changed) upload(brick);
  device_.check("changing bricks");
}

void BrickAtlas::upload(std::size_t brick) {
  const TexelType type = store_.description().type;
  const TexelFormat format = format_of(type);
  const std::array<int, 3> at = grid_.place(brick);
  const int blocks_along = grid_.edge / cells;
  std::array<int, 3> first{}, size{};  // in blocks; in texels
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first[axis] = at[axis] * blocks_along;
    const int lowest = (store_.first_block()[axis] + first[axis]) * cells;
    size[axis] = std::min(row(), store_.lattice().cells[axis] + 1 - lowest);
  }
  const auto line = std::size_t(row()), slice = line * line;
  const auto place = [&](int x, int y, int z) {
    return remote_.data() + (std::size_t(z) * slice + std::size_t(y) * line + std::size_t(x)) * format.bytes;
  };
  const auto& counts = store_.block_counts();
  for (int bz = 0; bz < blocks_along && first[2] + bz < counts[2]; ++bz)
    for (int by = 0; by < blocks_along && first[1] + by < counts[1]; ++by)
      for (int bx = 0; bx < blocks_along && first[0] + bx < counts[0]; ++bx) {
        const std::size_t block =
            (std::size_t(first[2] + bz) * std::size_t(counts[1]) + std::size_t(first[1] + by)) *
                std::size_t(counts[0]) +
            std::size_t(first[0] + bx);
        const auto kept = [&](int axis, int b) {
          return std::min(BrickStore::block_row, size[std::size_t(axis)] - b * cells);
        };
        for (int z = 0; z < kept(2, bz); ++z)
          for (int y = 0; y < kept(1, by); ++y)
            convert(type, store_.block_data()[block], z * BrickStore::block_slice + y * BrickStore::block_row,
                    kept(0, bx), place(bx * cells, by * cells + y, bz * cells + z));
      }
  // The held cells may end before the brick does. Texels beyond are never sampled, but the filter may read them
  // with a weight caused by rounding, so they repeat the outermost texels.
  for (std::size_t axis = 0; axis < 3; ++axis)
    size[axis] = std::min(size[axis], (counts[axis] - first[axis]) * cells + 1);
  for (int z = 0; z < row(); ++z)
    for (int y = 0; y < row(); ++y)
      for (int x = 0; x < row(); ++x)
        if (x >= size[0] || y >= size[1] || z >= size[2])
          std::memcpy(place(x, y, z),
                      place(std::min(x, size[0] - 1), std::min(y, size[1] - 1), std::min(z, size[2] - 1)),
                      format.bytes);

  const std::array<int, 3> slot = place_of(slot_of_[brick]);
  const Functions& gl = device_.gl();
  gl.BindTexture(GL_TEXTURE_3D, texels_.name());
  gl.TexSubImage3D(GL_TEXTURE_3D, 0, slot[0] * row(), slot[1] * row(), slot[2] * row(), row(), row(), row(),
                   format.pixels, format.type, remote_.data());
  ++uploads_;
}

void BrickAtlas::upload_pages() {
  std::vector<std::array<std::uint8_t, 4>> pages(grid_.bricks());
  for (std::size_t brick = 0; brick < pages.size(); ++brick)
    if (slot_of_[brick] != none) {
      const std::array<int, 3> slot = place_of(slot_of_[brick]);
      pages[brick] = {std::uint8_t(slot[0]), std::uint8_t(slot[1]), std::uint8_t(slot[2]), 1};
    }
  const Functions& gl = device_.gl();
  gl.BindTexture(GL_TEXTURE_3D, pages_.name());
  gl.TexImage3D(GL_TEXTURE_3D, 0, GL_RGBA8UI, grid_.counts[0], grid_.counts[1], grid_.counts[2], 0,
                GL_RGBA_INTEGER, GL_UNSIGNED_BYTE, pages.data());
}

}  // namespace understudy::volume::glsl
