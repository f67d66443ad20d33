// SPDX-License-Identifier: Apache-2.0
// The fragment shader that marches along one pixel's ray, in variants for different requests.
#pragma once

#include <compare>

#include "volume/blending_operator.h"
#include "volume/glsl/functions.h"
#include "volume/texture_filter.h"

namespace understudy::volume::glsl {

/// Compile-time properties of the shader: a variant contains no code for features that its request does not
/// use.
struct MarchVariant {
  bool colours = false;  ///< texels are RGBA, classified by a LinearMap
  bool bordered = false;
  Filter filter = Filter::linear;
  Operator op = Operator::over;
  /// The shader interpolates samples itself, in float, as on the CPU: OpenGL's filter has weights of few bits,
  /// which become visible with a steep table. On llvmpipe this takes 2.6 times as long.
  bool own_filter = false;
  /// The field consists of resident bricks (brick_passes.h), and rays wait at bricks that are not resident.
  bool bricked = false;
  bool whole_rays = false;  ///< RaySteps::cover_whole_ray

  auto operator<=>(const MarchVariant&) const = default;  // NOLINT(modernize-use-nullptr): there is no pointer
};

/// Texture units, fixed at link time.
enum class Unit : GLint { ray_starts, ray_steps, ray_ends, field, distances, table, pages, sums, progress };

struct MarchProgram {
  GLuint name = 0;
  // Locations of uniforms; -1 in variants without them.
  GLint texture_origin = -1;  ///< lattice position of the field texture's first texel, or of the first brick's
  GLint texture_scale = -1;   ///< 1 / its size
  GLint first_block = -1;
  GLint top = -1;
  GLint rounding = -1;
  GLint has_border = -1;
  GLint border = -1;
  GLint table_low = -1;  ///< of normalised values
  GLint table_scale = -1;
  GLint table_last = -1;
  GLint map = -1;
  GLint multiply_by_alpha = -1;
  GLint alpha_above = -1;
  GLint termination = -1;
  GLint opacity_limit = -1;
  GLint brick_cells = -1;
  GLint passes_before = -1;  ///< of this image
};

/// Requires a current context. Throws std::runtime_error with the compiler's message.
MarchProgram link_march_program(const Functions& gl, const MarchVariant& variant);

}  // namespace understudy::volume::glsl
