// SPDX-License-Identifier: Apache-2.0
// A desktop OpenGL context with a small framebuffer, by EGL and without a window system.
#pragma once

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <stdio.h>
#include <stdlib.h>

namespace client {

constexpr int size = 64;  ///< width and height of every framebuffer

/// Mesa has several displays that need no window system; each has a separate driver in the process.
enum class Platform : EGLenum { surfaceless = EGL_PLATFORM_SURFACELESS_MESA, device = EGL_PLATFORM_DEVICE_EXT };

[[noreturn]] inline void give_up(const char* what) {
  printf("%s fails\n", what);
  exit(3);
}

class Offscreen {
 public:
  explicit Offscreen(const Offscreen* share = nullptr, Platform platform = Platform::surfaceless) {
    display_ = eglGetPlatformDisplay(EGLenum(platform), EGL_DEFAULT_DISPLAY, nullptr);
    if (!eglInitialize(display_, nullptr, nullptr)) give_up("eglInitialize");
    eglBindAPI(EGL_OPENGL_API);
    const EGLint wanted[] = {EGL_SURFACE_TYPE,
                             EGL_PBUFFER_BIT,
                             EGL_RENDERABLE_TYPE,
                             EGL_OPENGL_BIT,
                             EGL_RED_SIZE,
                             8,
                             EGL_ALPHA_SIZE,
                             8,
                             EGL_DEPTH_SIZE,
                             24,
                             EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (!eglChooseConfig(display_, wanted, &config, 1, &count) || count == 0) give_up("eglChooseConfig");
    context_ = eglCreateContext(display_, config, share != nullptr ? share->context_ : EGL_NO_CONTEXT, nullptr);
    const EGLint extent[] = {EGL_WIDTH, size, EGL_HEIGHT, size, EGL_NONE};
    surface_ = eglCreatePbufferSurface(display_, config, extent);
    if (context_ == EGL_NO_CONTEXT || surface_ == EGL_NO_SURFACE) give_up("eglCreateContext");
  }
  Offscreen(const Offscreen&) = delete;
  Offscreen& operator=(const Offscreen&) = delete;

  void make_current() const {
    eglBindAPI(EGL_OPENGL_API);  // the current API is per thread
    if (!eglMakeCurrent(display_, surface_, surface_, context_)) give_up("eglMakeCurrent");
  }
  void release() const { eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }
  void swap() const { eglSwapBuffers(display_, surface_); }
  void destroy() const {
    eglDestroyContext(display_, context_);
    eglDestroySurface(display_, surface_);
  }

 private:
  EGLDisplay display_;
  EGLContext context_;
  EGLSurface surface_;
};

}  // namespace client
