// SPDX-License-Identifier: Apache-2.0
// Loads the OpenGL entry points of the current context.
#pragma once

namespace viewer {

/// Loads them and prints the OpenGL version. Throws Error (no_opengl) if the context is older than required.
void load_opengl_functions();

}  // namespace viewer
