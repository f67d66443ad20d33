// SPDX-License-Identifier: Apache-2.0
// How the field between texels, and beyond the outermost, is made of the texels: as by OpenGL's samplers.
#pragma once

#include <cstdint>

namespace understudy::volume {

/// Of GL_NEAREST and GL_LINEAR (OpenGL 4.6, section 8.14); no mip-mapping. `linear_8_bit` is linear as llvmpipe
/// filters textures of bytes: places are rounded to 1/256 of a texel, and of the interpolations along x, y and
/// z each gives a byte (rounded_mix()). It is for one byte a texel, without a border.
enum class Filter : std::uint8_t { nearest, linear, linear_8_bit };

/// Steps of a place between two texels under `linear_8_bit`.
constexpr int filter_steps = 256;

/// Of two texels, `step` of `filter_steps` from a to b, rounded to the nearest byte, halves up.
constexpr int rounded_mix(int a, int b, int step) {
  return ((filter_steps - step) * a + step * b + filter_steps / 2) / filter_steps;
}

/// What the linear filter reads beyond the outermost texels.
enum class Wrap : std::uint8_t { edge, border, repeat };

}  // namespace understudy::volume
