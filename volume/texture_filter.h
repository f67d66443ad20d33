// SPDX-License-Identifier: Apache-2.0
// How the field between texels, and beyond the outermost, is interpolated: as by OpenGL's samplers.
#pragma once

#include <cstdint>

namespace understudy::volume {

/// GL_NEAREST or GL_LINEAR (OpenGL 4.6, section 8.14); no mip-mapping. `linear_8_bit` is linear as llvmpipe
/// filters byte textures: positions are rounded to 1/256 of a texel, and each interpolation along x, y and z is
/// rounded to a byte (rounded_mix()). For one byte per texel, without a border.
enum class Filter : std::uint8_t { nearest, linear, linear_8_bit };

/// Number of positions between two texels under `linear_8_bit`.
constexpr int filter_steps = 256;

/// Interpolates `step` of `filter_steps` from a to b, rounded to the nearest byte, halves up.
constexpr int rounded_mix(int a, int b, int step) {
  return ((filter_steps - step) * a + step * b + filter_steps / 2) / filter_steps;
}

/// What the linear filter reads beyond the outermost texels. Under `nearest`, samples of a texture with a
/// border must not lie beyond it (validate()).
enum class Wrap : std::uint8_t { edge, border, repeat };

}  // namespace understudy::volume
