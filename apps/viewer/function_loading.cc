// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/function_loading.h"

#include <GL/glew.h>
#include <fmt/format.h>

#include <cstdio>

#include "apps/viewer/model/error.h"

namespace viewer {

void load_opengl_functions() {
  glewExperimental = GL_TRUE;  // in core profiles, GLEW's extension query is an error
  const GLenum result = glewInit();
  // Without a window, GLEW finds no GLX display, but has loaded the OpenGL functions by then.
  if (result != GLEW_OK && result != GLEW_ERROR_NO_GLX_DISPLAY)
    throw Error(
        ExitCode::no_opengl,
        fmt::format("OpenGL functions cannot be loaded: {}; check the OpenGL installation (glxinfo, eglinfo)",
                    reinterpret_cast<const char*>(glewGetErrorString(result))));
  while (glGetError() != GL_NO_ERROR) {
  }
  const auto* version = reinterpret_cast<const char*>(glGetString(GL_VERSION));
  const auto* renderer = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  if (!version || !renderer || !glTexImage3D || !glUseProgram)
    throw Error(
        ExitCode::no_opengl,
        fmt::format("OpenGL {} is too old, 2.0 is required; update the driver or set LIBGL_ALWAYS_SOFTWARE=1",
                    version ? version : "(none)"));
  fmt::print("OpenGL {}, {}\n", version, renderer);
}

}  // namespace viewer
