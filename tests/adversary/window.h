// SPDX-License-Identifier: Apache-2.0
// A window as far as OpenGL is concerned: a pbuffer with its context, which ends frames by eglSwapBuffers.
#pragma once

#include <EGL/egl.h>

namespace adversary {

enum class Profile { compatibility, core };

class Window {
 public:
  /// OpenGL 4.5 with colours and alpha of 8 bits, depth of 24 and stencil of 8. Throws std::runtime_error.
  Window(Profile profile, int width, int height);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// What was drawn before is lost, as in a window that the user resizes.
  void resize(int width, int height);
  void swap();

 private:
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLConfig config_ = nullptr;
  EGLContext context_ = EGL_NO_CONTEXT;
  EGLSurface surface_ = EGL_NO_SURFACE;
};

}  // namespace adversary
