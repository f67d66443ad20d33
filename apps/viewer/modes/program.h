// SPDX-License-Identifier: Apache-2.0
// Compiles and links a GLSL program from a vertex and a fragment shader.
#pragma once

#include <string>

#include "apps/viewer/modes/gl_objects.h"

namespace viewer {

/// Throws Error (no_opengl) with the compiler's log; `name` identifies the program.
Program link_program(const std::string& name, const char* vertex_source, const char* fragment_source);

}  // namespace viewer
