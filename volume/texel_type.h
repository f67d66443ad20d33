// SPDX-License-Identifier: Apache-2.0
// The types in which a volume's texels are stored and sent.
#pragma once

#include <cstddef>
#include <cstdint>

namespace understudy::volume {

/// One scalar per texel, normalised when sampled (u8: v / 255, u16: v / 65535, f32: as is), or four bytes.
enum class TexelType : std::uint8_t { u8, u16, f32, rgba8 };
/// 1, 2 or 4.
constexpr std::size_t bytes_per_texel(TexelType type) {
  return type == TexelType::u8 ? 1 : type == TexelType::u16 ? 2 : 4;
}
/// The stored value that is 1 when sampled.
constexpr double largest_texel(TexelType type) {
  return type == TexelType::f32 ? 1 : type == TexelType::u16 ? 65535 : 255;
}

}  // namespace understudy::volume
