// SPDX-License-Identifier: Apache-2.0
// A cube of slices between whatever else a test draws: fixed function, one glBegin/glEnd of quads.
#pragma once

#include <array>

#include "gl_application.h"

namespace understudy::spu::testing {

enum class View { perspective, parallel };

/// A cube of edge 1 around the origin, turned, then moved sideways.
void look(GlApplication& app, View view, double angle, double sideways = 0);

/// RGBA8 colours of the blob, or of its mirror image in other colours. Leaves the texture bound and returns it.
GLuint load_colours(GlApplication& app, bool mirrored = false);

/// The bound 3-D texture in 40 slices, back to front as seen by look(), under SRC_ALPHA, 1 - SRC_ALPHA. Depth
/// state is the caller's; blending and texturing are off afterwards.
void draw_cube(GlApplication& app);

/// A square of edge `edge` across the cube at height z, in one colour.
void draw_square(GlApplication& app, double edge, double z, const std::array<float, 4>& colour);

}  // namespace understudy::spu::testing
