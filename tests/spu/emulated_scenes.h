// SPDX-License-Identifier: Apache-2.0
// The frames that scenes of tests/spu draw, for the judge in double precision.
#pragma once

#include <span>
#include <vector>

#include "gl_application.h"
#include "tests/emulation/precision.h"

namespace understudy::spu::testing {

/// Blob's texels from 0 to 1, after `of_texel`.
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

/// How the cube of slices is seen: by what fixed_function_camera() and look() do.
emulation::Matrix cube_camera(double angle, bool parallel = false, double sideways = 0, double backwards = 0);

/// immediate_rgba() with texels of four components each.
emulation::Volume colour_cube(std::vector<double> colours, double angle, bool front_to_back = false);
/// client_arrays_table() with these values in its texture.
emulation::Volume table_cube(std::vector<double> values, double angle, bool front_to_back = false);

/// One frame of GlApplication's size.
emulation::Frame frame_of(std::vector<emulation::Volume> volumes, const emulation::Colour& background,
                          const emulation::Blending& blending = {usual_function, usual_function});

/// Prints how the pixels (RGBA, bottom row first) lie to the image, and expects all of the first `channels`
/// of each within their bounds. `slack` is added to these: what ends rays, and what float blends round.
void expect_within(const char* what, const emulation::Image& image, const std::vector<float>& pixels,
                   int channels = 4, double slack = emulation::ray_termination);

/// How many of these channels lie outside of their bounds.
int channels_outside(const emulation::Image& image, const std::vector<float>& pixels, int channels = 4,
                     double slack = emulation::ray_termination);

/// What Understudy may show of the frame in a framebuffer of 8 bits.
emulation::Image shown_in_bytes(const emulation::Frame& frame,
                                emulation::Precision precision = emulation::ours);

}  // namespace understudy::spu::testing
