// SPDX-License-Identifier: Apache-2.0
// A context without a window: EGL on a device or surfaceless platform, no display server needed.
//
// Frames are drawn into a pbuffer surface and ended by eglSwapBuffers where the platform offers pbuffers,
// otherwise into a framebuffer object and ended by glFinish.
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

/// The whole program off screen: draws options.frames frames of `volume`.
void run_offscreen(const Options& options, Volume volume);

}  // namespace viewer
