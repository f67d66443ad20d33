// SPDX-License-Identifier: Apache-2.0
// A context without a window: EGL on a device or surfaceless platform, without a display server.
//
// If the platform offers pbuffers, frames are drawn to a pbuffer and ended by eglSwapBuffers; otherwise they
// are drawn to a framebuffer object and ended by glFinish.
#pragma once

#include <EGL/egl.h>

#include "apps/viewer/options.h"

namespace viewer {

class Offscreen {
 public:
  /// Makes the context current (compatibility, or 3.3 core for ModeKind::core; with alpha for Operator::under)
  /// and loads OpenGL's functions. Throws Error (no_opengl) with what was tried.
  Offscreen(const Options& options, int width, int height);
  Offscreen(const Offscreen&) = delete;
  Offscreen& operator=(const Offscreen&) = delete;
  ~Offscreen();

  /// Ends a frame.
  void present();

 private:
  bool open(EGLDisplay display, const Options& options, OffscreenSurface surface, int width, int height);
  void close();
  void make_framebuffer(int width, int height);

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  EGLSurface surface_ = EGL_NO_SURFACE;
  unsigned framebuffer_ = 0;
  std::array<unsigned, 2> renderbuffers_{};  ///< colour, depth
};

/// Runs the program off screen: draws options.frames frames of `volume`.
void run_offscreen(const Options& options, Volume volume);

}  // namespace viewer
