// SPDX-License-Identifier: Apache-2.0
// In which numbers a volume's texels are kept and travel.
#pragma once

#include <cstddef>
#include <cstdint>

namespace understudy::volume {

/// One number a texel, normalised when sampled (u8: v / 255, u16: v / 65535, f32: as it is), or four bytes.
enum class TexelType : std::uint8_t { u8, u16, f32, rgba8 };
/// 1, 2 or 4.
constexpr std::size_t bytes_per_texel(TexelType type) {
  return type == TexelType::u8 ? 1 : type == TexelType::u16 ? 2 : 4;
}
/// What is 1 when sampled.
constexpr double largest_texel(TexelType type) {
  return type == TexelType::f32 ? 1 : type == TexelType::u16 ? 65535 : 255;
}

}  // namespace understudy::volume
