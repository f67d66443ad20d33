// SPDX-License-Identifier: Apache-2.0
// A viewer of the days of OpenGL 2: slices in immediate mode, matrices of fixed function, programs in GLSL 1.x
// or none.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/adversary/blending.h"
#include "tests/adversary/glsl_program.h"
#include "tests/adversary/slice_polygons.h"
#include "tests/adversary/textures.h"

namespace adversary {

/// Gives gl_TexCoord[0], by ftransform().
extern const std::string old_vertex_shader;

/// Takes the camera's matrices, and clears the canvas before.
void begin_old_frame(const Canvas& canvas, const Camera& camera);
/// glBegin(GL_POLYGON) for each, with texture coordinates that equal positions.
void draw_polygons(const Gl& gl, const std::vector<Polygon>& polygons);
Camera old_camera(const Canvas& canvas, int frame, const Orbit& orbit = {});

}  // namespace adversary
