// SPDX-License-Identifier: Apache-2.0
// Texture formats of the texel types. Bytes are widened to 16 bits, because some drivers filter 8-bit textures
// with 8-bit precision.
#pragma once

#include <array>
#include <cstddef>

#include "volume/glsl/functions.h"
#include "volume/texel_type.h"

namespace understudy::volume::glsl {

struct TexelFormat {
  GLint internal = 0;
  GLenum pixels = 0;
  GLenum type = 0;
  std::size_t bytes = 0;  ///< per texel
};

TexelFormat format_of(TexelType type);

/// Converts `count` texels of a block, from texel `from` on, to the texture's format. Throws NotSupported if
/// one is NaN, because OpenGL's filter need not propagate it.
void convert(TexelType type, const std::byte* block, int from, int count, std::byte* to);

/// Allocates undefined texels of this size for the bound 3D texture, with linear filtering. Nearest samples are
/// fetched with texelFetch.
void allocate(const Functions& gl, const TexelFormat& format, const std::array<int, 3>& size);

}  // namespace understudy::volume::glsl
