// SPDX-License-Identifier: Apache-2.0
// The framebuffer configurations that remote GLX and EGL offer: for each kind of window of the X server that
// can show images, with and without alpha, a second buffer, depth and samples. Drawing happens on the GL
// server, which supports all of these.
#pragma once

#include <X11/Xlib.h>
#include <X11/Xutil.h>

namespace understudy::interceptor {

struct RemoteConfig {
  int id;  ///< GLX_FBCONFIG_ID, EGL_CONFIG_ID: from 1
  int screen;
  VisualID visual;   ///< 0: no X server, only pbuffers
  int visual_depth;  ///< 24, or 32 with an alpha channel that the screen shows; 0 without a visual
  int alpha;         ///< 0 or 8 bits
  int double_buffered;
  int depth;
  int stencil;
  int samples;
};

/// The configurations of a screen (`display` null: without one), best first; null and count 0 if the server has
/// no TrueColor visual of 24 or 32 bits. They are never freed.
const RemoteConfig* remote_configs(Display* display, int screen, int* count);

/// The visual as XGetVisualInfo returns it, to be freed with XFree; null if the server no longer has it.
XVisualInfo* visual_of(Display* display, const RemoteConfig& config);

}  // namespace understudy::interceptor
