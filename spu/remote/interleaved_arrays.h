// SPDX-License-Identifier: Apache-2.0
// The formats of glInterleavedArrays (OpenGL 2.1, table 2.5): a vertex consists of texture coordinates, a
// colour, a normal and a position, in this order.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "dispatch/table.h"

namespace understudy::spu {

struct InterleavedFormat {
  GLint texture_coordinates = 0;  ///< components; 0: there are none
  GLint color = 0;
  GLenum color_type = GL_FLOAT;
  bool normal = false;
  GLint position = 0;

  constexpr std::uint64_t color_at() const { return 4 * std::uint64_t(texture_coordinates); }
  constexpr std::uint64_t normal_at() const {
    return color_at() + 4 * std::uint64_t(color_type == GL_UNSIGNED_BYTE ? 1 : color);
  }
  constexpr std::uint64_t position_at() const { return normal_at() + (normal ? 12 : 0); }
  constexpr std::uint64_t bytes() const { return position_at() + 4 * std::uint64_t(position); }
};

/// Null if the format is invalid.
inline const InterleavedFormat* interleaved_format(GLenum name) {
  static constexpr std::array<InterleavedFormat, 14> formats = {{
      {0, 0, GL_FLOAT, false, 2},          // GL_V2F
      {0, 0, GL_FLOAT, false, 3},          // GL_V3F
      {0, 4, GL_UNSIGNED_BYTE, false, 2},  // GL_C4UB_V2F
      {0, 4, GL_UNSIGNED_BYTE, false, 3},  // GL_C4UB_V3F
      {0, 3, GL_FLOAT, false, 3},          // GL_C3F_V3F
      {0, 0, GL_FLOAT, true, 3},           // GL_N3F_V3F
      {0, 4, GL_FLOAT, true, 3},           // GL_C4F_N3F_V3F
      {2, 0, GL_FLOAT, false, 3},          // GL_T2F_V3F
      {4, 0, GL_FLOAT, false, 4},          // GL_T4F_V4F
      {2, 4, GL_UNSIGNED_BYTE, false, 3},  // GL_T2F_C4UB_V3F
      {2, 3, GL_FLOAT, false, 3},          // GL_T2F_C3F_V3F
      {2, 0, GL_FLOAT, true, 3},           // GL_T2F_N3F_V3F
      {2, 4, GL_FLOAT, true, 3},           // GL_T2F_C4F_N3F_V3F
      {4, 4, GL_FLOAT, true, 4},           // GL_T4F_C4F_N3F_V4F
  }};
  static_assert(GL_T4F_C4F_N3F_V4F - GL_V2F + 1 == formats.size());
  return name < GL_V2F || name > GL_T4F_C4F_N3F_V4F ? nullptr : &formats[name - GL_V2F];
}

}  // namespace understudy::spu
