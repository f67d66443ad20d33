// SPDX-License-Identifier: Apache-2.0
// A cube of slices among a test's other drawing: fixed function, one glBegin/glEnd of quads.
#pragma once

#include <array>

#include "gl_application.h"

namespace understudy::spu::testing {

enum class View { perspective, parallel };

/// Sets the camera for a unit cube around the origin, rotated and then moved sideways.
void look(GlApplication& app, View view, double angle, double sideways = 0);

/// Loads RGBA8 colours of the blob, or of its mirror image in other colours. Leaves the texture bound and
/// returns it.
GLuint load_colours(GlApplication& app, bool mirrored = false);

/// Draws the bound 3-D texture in 40 slices, back to front as seen by look(), with SRC_ALPHA, 1 - SRC_ALPHA.
/// Depth state is set by the caller; blending and texturing are off afterwards.
void draw_cube(GlApplication& app);

/// Draws a square with edge `edge` through the cube at height z, in one colour.
void draw_square(GlApplication& app, double edge, double z, const std::array<float, 4>& colour);

}  // namespace understudy::spu::testing
