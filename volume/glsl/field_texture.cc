#include "volume/glsl/field_texture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

namespace understudy::volume::glsl {

namespace {

constexpr int cells = BrickStore::block_cells, row = BrickStore::block_row, slice = BrickStore::block_slice;

struct Format {
  GLint internal = 0;
  GLenum pixels = 0;
  GLenum type = 0;
  int channels = 1;
  std::size_t bytes = 0;  ///< of a texel
};

Format format_of(TexelType type) {
  switch (type) {
    case TexelType::u8:
    case TexelType::u16:
      return {GL_R16, GL_RED, GL_UNSIGNED_SHORT, 1, 2};
    case TexelType::f32:
      return {GL_R32F, GL_RED, GL_FLOAT, 1, 4};
    case TexelType::rgba8:
      return {GL_RGBA16, GL_RGBA, GL_UNSIGNED_SHORT, 4, 8};
  }
  return {};
}

/// `count` texels of a block from texel `from` on, as the texture takes them.
void convert(TexelType type, const std::byte* block, int from, int count, std::byte* to) {
  if (type == TexelType::u16 || type == TexelType::f32) {
    const std::size_t bytes = bytes_per_texel(type);
    std::memcpy(to, block + std::size_t(from) * bytes, std::size_t(count) * bytes);
    for (int i = 0; type == TexelType::f32 && i < count; ++i) {
      float value = 0;
      std::memcpy(&value, to + sizeof value * std::size_t(i), sizeof value);
      if (std::isnan(value)) throw NotSupported("the volume has texels that are not numbers");
    }
    return;
  }
  const int channels = type == TexelType::rgba8 ? 4 : 1;
  for (int i = 0; i < count * channels; ++i) {
    // v / 255 is v * 257 / 65535.
    const auto wide = std::uint16_t(257 * std::to_integer<int>(block[from * channels + i]));
    std::memcpy(to + 2 * i, &wide, sizeof wide);
  }
}

}  // namespace

FieldTexture::FieldTexture(Device& device, const BrickStore& store)
    : device_(device), store_(store), texture_(device.gl()) {
  const Format format = format_of(store.description().type);
  std::uint64_t bytes = format.bytes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int first = store.first_block()[axis] * cells;
    size_[axis] = std::min(store.block_counts()[axis] * cells + 1, store.lattice().cells[axis] + 1 - first);
    bytes *= std::uint64_t(size_[axis]);
    if (size_[axis] > device.max_volume_edge())
      throw NotSupported(
          fmt::format("{} texels along axis {} of the nodes' share: this OpenGL's 3-D textures take {} "
                      "(GL_MAX_3D_TEXTURE_SIZE)",
                      size_[axis], axis, device.max_volume_edge()));
  }
  if (bytes > max_field_bytes)
    throw NotSupported(
        fmt::format("a texture of {} MiB is over the GL backend's limit of {} MiB: use more nodes", bytes >> 20,
                    max_field_bytes >> 20));

  const Functions& gl = device.gl();
  gl.BindTexture(GL_TEXTURE_3D, texture_.name());
  gl.TexImage3D(GL_TEXTURE_3D, 0, format.internal, size_[0], size_[1], size_[2], 0, format.pixels, format.type,
                nullptr);
  device.check("making the volume's texture");
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    gl.TexParameteri(GL_TEXTURE_3D, axis, GL_CLAMP_TO_EDGE);
  gl.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAX_LEVEL, 0);
  for (const GLenum when : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    gl.TexParameteri(GL_TEXTURE_3D, when, GL_LINEAR);  // nearest samples are fetched

  // One layer of blocks after the other; faces that two blocks share are the same texels.
  const auto& counts = store.block_counts();
  const std::size_t slice_texels = std::size_t(size_[0]) * std::size_t(size_[1]);
  std::vector<std::byte> layer(slice_texels * row * format.bytes);
  std::size_t block = 0;
  for (int bz = 0; bz < counts[2]; ++bz) {
    const int slices = std::min(row, size_[2] - bz * cells);
    for (int by = 0; by < counts[1]; ++by)
      for (int bx = 0; bx < counts[0]; ++bx, ++block) {
        const int width = std::min(row, size_[0] - bx * cells), height = std::min(row, size_[1] - by * cells);
        for (int z = 0; z < slices; ++z)
          for (int y = 0; y < height; ++y) {
            const std::size_t place =
                (std::size_t(z) * std::size_t(size_[1]) + std::size_t(by * cells + y)) * std::size_t(size_[0]) +
                std::size_t(bx * cells);
            convert(store.description().type, store.block_data()[block], z * slice + y * row, width,
                    layer.data() + place * format.bytes);
          }
      }
    upload({0, 0, bz * cells}, {size_[0], size_[1], slices}, layer.data());
  }
  device.check("filling the volume's texture");
}

void FieldTexture::upload(const std::array<int, 3>& at, const std::array<int, 3>& size, const void* texels) {
  const Format format = format_of(store_.description().type);
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
    const std::array<int, 3> at{int(block % std::size_t(counts[0])) * cells,
                                int(block / std::size_t(counts[0]) % std::size_t(counts[1])) * cells,
                                int(block / std::size_t(counts[0]) / std::size_t(counts[1])) * cells};
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

std::array<float, 3> FieldTexture::origin() const {
  std::array<float, 3> origin{};
  for (std::size_t axis = 0; axis < 3; ++axis) origin[axis] = float(store_.first_block()[axis] * cells);
  return origin;
}

}  // namespace understudy::volume::glsl
