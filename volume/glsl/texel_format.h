// SPDX-License-Identifier: Apache-2.0
// How texels of each type lie in a texture. Bytes are widened to 16 bits: some drivers filter 8-bit textures in
// 8 bits.
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
  std::size_t bytes = 0;  ///< of a texel
};

TexelFormat format_of(TexelType type);

/// `count` texels of a block from texel `from` on, as the texture takes them. Throws NotSupported when one is
/// not a number: OpenGL's filter need not carry that on.
void convert(TexelType type, const std::byte* block, int from, int count, std::byte* to);

/// Gives the 3-D texture that is bound undefined texels of this size, filtered linearly. Nearest samples are
/// fetched.
void allocate(const Functions& gl, const TexelFormat& format, const std::array<int, 3>& size);

}  // namespace understudy::volume::glsl
