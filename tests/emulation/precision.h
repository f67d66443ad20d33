// SPDX-License-Identifier: Apache-2.0
// Arithmetic precision of Understudy and of the driver beneath it. The bounds of all tests that judge images
// are defined here, each derived from the arithmetic that its comment names.
#pragma once

#include "tests/emulation/slices.h"

namespace emulation {

/// Half the spacing of floats just below 1: the relative error of one rounding.
constexpr double float_step = 1.0 / (1 << 24);
/// Step of an 8-bit channel, for colours in [0,1].
constexpr double byte_step = 1.0 / 255;

/// A ray ends where its transparency falls below this (RenderRequest::termination). What lies behind is no
/// brighter than 1.
constexpr double ray_termination = 5e-6;
/// The same limit for separately rendered alpha in a framebuffer with at most 8 bits of alpha.
constexpr double alpha_termination = 1e-3;

/// Precision of what the nodes receive and of their sampling. Texture coordinates arrive as floats through the
/// camera that was fitted to float clip positions (one rounding in each of x, y and w); a sample's position in
/// texels is a float that was rounded three times. Texture coordinates are at most 1, so eight roundings bound
/// both. Bytes are interpolated with 15-bit weights. Transfer functions are measured at 16 * 255 + 1 values.
/// Slices are compared with a 24-bit depth buffer whose triangles have their vertices on the rasteriser's grid
/// of 1/256 pixel (GL_SUBPIXEL_BITS is 8). Depth is interpolated in float.
constexpr Precision ours{.coordinate = 8 * float_step,
                         .texel = 1.0 / (1 << 15),
                         .value = float_step,
                         .solid = 1.0 / 256,
                         .depth = 4 * float_step,
                         .table_cells = 16 * 255};

/// The driver's own slices. Their vertices lie on the rasteriser's grid as well. llvmpipe filters byte textures
/// in bytes: with 8-bit weights, and each of the three levels of a trilinear interpolation may lose one step.
constexpr Precision drivers{.coordinate = 8 * float_step,
                            .window = 1.0 / 256,
                            .texel = 1.0 / 256,
                            .value = 3 * byte_step,
                            .solid = 1.0 / 256,
                            .depth = 4 * float_step};

/// Blending into normalised integers. The fragment's channels are rounded first, by half a step each. Each of
/// the two products may be off by a whole step, because integer products need not be rounded to nearest.
constexpr Rounding normalised(int bits, int alpha_bits) {
  const double step = 1.0 / ((1 << bits) - 1), alpha_step = 1.0 / ((1 << alpha_bits) - 1);
  return {.source = 0.5 * step,
          .result = 2 * step,
          .alpha_source = 0.5 * alpha_step,
          .alpha_result = 2 * alpha_step};
}

/// Blending into floats with `mantissa_bits` bits of mantissa. The two products and the sum are rounded once
/// each as 32-bit floats; conversion to a shorter format may cut off up to a whole step.
constexpr Rounding floating(int mantissa_bits) {
  const double stored = mantissa_bits >= 23 ? 0 : 1.0 / (1 << mantissa_bits);
  return {.relative = 3 * float_step + stored, .clamps = false};
}

/// A volume's image as a whole is blended with GL_ONE and one other factor: one product instead of two.
constexpr Rounding presented(Rounding rounding) {
  rounding.result /= 2;
  rounding.alpha_result /= 2;
  return rounding;
}

}  // namespace emulation
