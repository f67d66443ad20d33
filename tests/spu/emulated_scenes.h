// SPDX-License-Identifier: Apache-2.0
// The frames that the scenes of tests/spu draw, for the emulation in double precision.
#pragma once

#include <span>
#include <vector>

#include "gl_application.h"
#include "tests/emulation/precision.h"

namespace understudy::spu::testing {

/// The texels as values in [0,1], mapped by `of_texel`.
template <typename OfTexel>
std::vector<double> texels_of(std::span<const std::uint8_t> texels, OfTexel of_texel) {
  std::vector<double> values;
  for (const std::uint8_t s : texels)
    for (const double value : of_texel(s)) values.push_back(value);
  return values;
}

/// The colours of immediate_rgba(), 0 to 1.
std::vector<double> blob_colours();
/// The values of client_arrays_table().
std::vector<double> blob_values();

constexpr emulation::BlendFunction usual_function{emulation::Equation::add, emulation::Factor::source_alpha,
                                                  emulation::Factor::one_minus_source_alpha};

/// Camera of the cube of slices, as fixed_function_camera() and look() set it.
emulation::Matrix cube_camera(double angle, bool parallel = false, double sideways = 0, double backwards = 0);

/// immediate_rgba() with texels of four components each.
emulation::Volume colour_cube(std::vector<double> colours, double angle, bool front_to_back = false);
/// client_arrays_table() with these values in its texture.
emulation::Volume table_cube(std::vector<double> values, double angle, bool front_to_back = false);

/// A frame of GlApplication's size.
emulation::Frame frame_of(std::vector<emulation::Volume> volumes, const emulation::Colour& background,
                          const emulation::Blending& blending = {usual_function, usual_function});

/// Prints how the pixels (RGBA, bottom row first) compare with the image, and expects the first `channels`
/// channels of each within their bounds. `slack` widens the bounds: for early ray termination and the rounding
/// of float blending.
void expect_within(const char* what, const emulation::Image& image, const std::vector<float>& pixels,
                   int channels = 4, double slack = emulation::ray_termination);

/// Number of channels outside their bounds.
int channels_outside(const emulation::Image& image, const std::vector<float>& pixels, int channels = 4,
                     double slack = emulation::ray_termination);

/// The image that Understudy may show of the frame in an 8-bit framebuffer.
emulation::Image shown_in_bytes(const emulation::Frame& frame,
                                emulation::Precision precision = emulation::ours);

}  // namespace understudy::spu::testing
