// SPDX-License-Identifier: Apache-2.0
#include "volume/glsl/field_texture.h"

#include <algorithm>
#include <vector>

#include "volume/glsl/texel_format.h"
#include "volume/texel_type.h"

namespace understudy::volume::glsl {

namespace {

constexpr int cells_of_block = BrickStore::block_cells, row = BrickStore::block_row,
              slice = BrickStore::block_slice;

}  // namespace

std::array<int, 3> FieldTexture::size_of(const BrickStore& store) {
  std::array<int, 3> size{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int first = store.first_block()[axis] * cells_of_block;
    size[axis] =
        std::min(store.block_counts()[axis] * cells_of_block + 1, store.lattice().cells[axis] + 1 - first);
  }
  return size;
}

bool FieldTexture::fits(const Device& device, const BrickStore& store) {
  const std::array<int, 3> size = size_of(store);
  return *std::max_element(size.begin(), size.end()) <= device.max_volume_edge() &&
         bytes_of(store) <= device.texture_memory().left();
}

std::uint64_t FieldTexture::bytes_of(const BrickStore& store) {
  std::uint64_t bytes = format_of(store.description().type).bytes;
  for (const int edge : size_of(store)) bytes *= std::uint64_t(edge);
  return bytes;
}

FieldTexture::FieldTexture(Device& device, const BrickStore& store)
    : device_(device),
      store_(store),
      memory_(device.texture_memory(), bytes_of(store)),
      texture_(device.gl()),
      size_(size_of(store)) {
  const TexelFormat format = format_of(store.description().type);
  const Functions& gl = device.gl();
  gl.BindTexture(GL_TEXTURE_3D, texture_.name());
  allocate(gl, format, size_);
  device.check("making the volume's texture");

  // One layer of blocks at a time; faces shared by two blocks are the same texels.
  const auto& counts = store.block_counts();
  const std::size_t slice_texels = std::size_t(size_[0]) * std::size_t(size_[1]);
  std::vector<std::byte> layer(slice_texels * row * format.bytes);
  std::size_t block = 0;
  for (int bz = 0; bz < counts[2]; ++bz) {
    const int slices = std::min(row, size_[2] - bz * cells_of_block);
    for (int by = 0; by < counts[1]; ++by)
      for (int bx = 0; bx < counts[0]; ++bx, ++block) {
        const int width = std::min(row, size_[0] - bx * cells_of_block),
                  height = std::min(row, size_[1] - by * cells_of_block);
        for (int z = 0; z < slices; ++z)
          for (int y = 0; y < height; ++y) {
            const std::size_t place =
                (std::size_t(z) * std::size_t(size_[1]) + std::size_t(by * cells_of_block + y)) *
                    std::size_t(size_[0]) +
                std::size_t(bx * cells_of_block);
            convert(store.description().type, store.block_data()[block], z * slice + y * row, width,
                    layer.data() + place * format.bytes);
          }
      }
    upload({0, 0, bz * cells_of_block}, {size_[0], size_[1], slices}, layer.data());
  }
  device.check("filling the volume's texture");
}

void FieldTexture::upload(const std::array<int, 3>& at, const std::array<int, 3>& size, const void* texels) {
  const TexelFormat format = format_of(store_.description().type);
  device_.gl().TexSubImage3D(GL_TEXTURE_3D, 0, at[0], at[1], at[2], size[0], size[1], size[2], format.pixels,
                             format.type, texels);
}

void FieldTexture::blocks_changed(std::span<const std::size_t> blocks) {
  const TexelType type = store_.description().type;
  const std::size_t bytes = format_of(type).bytes;
  const auto& counts = store_.block_counts();
  std::vector<std::byte> texels(BrickStore::block_texels * bytes);
  device_.gl().BindTexture(GL_TEXTURE_3D, texture_.name());
  for (const std::size_t block : blocks) {
    const std::array<int, 3> at{int(block % std::size_t(counts[0])) * cells_of_block,
                                int(block / std::size_t(counts[0]) % std::size_t(counts[1])) * cells_of_block,
                                int(block / std::size_t(counts[0]) / std::size_t(counts[1])) * cells_of_block};
    std::array<int, 3> size{};
    for (std::size_t axis = 0; axis < 3; ++axis) size[axis] = std::min(row, size_[axis] - at[axis]);
    std::byte* to = texels.data();
    for (int z = 0; z < size[2]; ++z)
      for (int y = 0; y < size[1]; ++y, to += std::size_t(size[0]) * bytes)
        convert(type, store_.block_data()[block], z * slice + y * row, size[0], to);
    upload(at, size, texels.data());
  }
  device_.check("changing the volume's texture");
}

}  // namespace understudy::volume::glsl
