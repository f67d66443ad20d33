// SPDX-License-Identifier: Apache-2.0
#include "volume/glsl/texel_format.h"

#include <cmath>
#include <cstdint>
#include <cstring>

#include "volume/glsl/device.h"

namespace understudy::volume::glsl {

TexelFormat format_of(TexelType type) {
  switch (type) {
    case TexelType::u8:
    case TexelType::u16:
      return {GL_R16, GL_RED, GL_UNSIGNED_SHORT, 2};
    case TexelType::f32:
      return {GL_R32F, GL_RED, GL_FLOAT, 4};
    case TexelType::rgba8:
      return {GL_RGBA16, GL_RGBA, GL_UNSIGNED_SHORT, 8};
  }
  return {};
}

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
    // v / 255 equals v * 257 / 65535.
    const auto wide = std::uint16_t(257 * std::to_integer<int>(block[from * channels + i]));
    std::memcpy(to + 2 * i, &wide, sizeof wide);
  }
}

void allocate(const Functions& gl, const TexelFormat& format, const std::array<int, 3>& size) {
  gl.TexImage3D(GL_TEXTURE_3D, 0, format.internal, size[0], size[1], size[2], 0, format.pixels, format.type,
                nullptr);
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    gl.TexParameteri(GL_TEXTURE_3D, axis, GL_CLAMP_TO_EDGE);
  gl.TexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAX_LEVEL, 0);
  for (const GLenum when : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    gl.TexParameteri(GL_TEXTURE_3D, when, GL_LINEAR);
}

}  // namespace understudy::volume::glsl
