// SPDX-License-Identifier: Apache-2.0
// OpenGL entry points for the current context.
#pragma once

namespace viewer {

/// Loads them and prints which OpenGL this is. Throws Error (no_opengl) when the context is older than needed.
void load_opengl_functions();

}  // namespace viewer
