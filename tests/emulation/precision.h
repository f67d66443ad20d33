// SPDX-License-Identifier: Apache-2.0
// How exactly Understudy and the driver beneath it calculate. The bounds of all tests that judge images come
// from here, and each number from the arithmetic that it names.
#pragma once

#include "tests/emulation/slices.h"

namespace emulation {

/// Half a step of floats just below 1, the relative error of one rounding.
constexpr double float_step = 1.0 / (1 << 24);
/// A byte's step, of colours in [0,1].
constexpr double byte_step = 1.0 / 255;

/// A ray ends where its transparency falls below this (RenderRequest::termination); what is behind is no
/// brighter than 1.
constexpr double ray_termination = 5e-6;
/// Where a framebuffer has 8 bits of alpha or less, and alpha is made by itself, it ends here.
constexpr double alpha_termination = 1e-3;

/// What the nodes are told, and how they sample. Texture coordinates reach them as floats, through the camera
/// that is fitted to float clip positions (each good for one rounding in every of x, y and w), and a sample's
/// place among the texels is a float that was rounded three times: eight roundings in all, texture coordinates
/// being at most 1. Bytes are interpolated with weights of 15 bits. Tables are measured at 16 * 255 + 1 values.
/// Slices are compared with a depth buffer of 24 bits, whose triangles' vertices the rasteriser puts on a grid
/// of 1/256 pixel (GL_SUBPIXEL_BITS is 8); depth is interpolated in float.
constexpr Precision ours{.coordinate = 8 * float_step,
                         .texel = 1.0 / (1 << 15),
                         .value = float_step,
                         .solid = 1.0 / 256,
                         .depth = 4 * float_step,
                         .table_cells = 16 * 255};

/// The driver's own slices. Their vertices lie on the rasteriser's grid, too. llvmpipe filters textures of
/// bytes in bytes: weights of 8 bits, and each of the three levels of a trilinear interpolation may lose a
/// step.
constexpr Precision drivers{.coordinate = 8 * float_step,
                            .window = 1.0 / 256,
                            .texel = 1.0 / 256,
                            .value = 3 * byte_step,
                            .solid = 1.0 / 256,
                            .depth = 4 * float_step};

/// Blending into normalised integers: a fragment's channels are rounded first, half a step each, and each of
/// the two products by a whole step, because products of integers need not be rounded to the nearest.
constexpr Rounding normalised(int bits, int alpha_bits) {
  const double step = 1.0 / ((1 << bits) - 1), alpha_step = 1.0 / ((1 << alpha_bits) - 1);
  return {.source = 0.5 * step,
          .result = 2 * step,
          .alpha_source = 0.5 * alpha_step,
          .alpha_result = 2 * alpha_step};
}

/// Floats with so many bits of mantissa: the two products and the sum round once each while they are floats of
/// 32 bits, and a conversion to a shorter format may cut off up to a whole step.
constexpr Rounding floating(int mantissa_bits) {
  const double stored = mantissa_bits >= 23 ? 0 : 1.0 / (1 << mantissa_bits);
  return {.relative = 3 * float_step + stored, .clamps = false};
}

/// A volume's image as a whole is blended by ONE and one other factor: there is one product, not two.
constexpr Rounding presented(Rounding rounding) {
  rounding.result /= 2;
  rounding.alpha_result /= 2;
  return rounding;
}

}  // namespace emulation
