// SPDX-License-Identifier: Apache-2.0
// The framebuffer configurations that remote GLX and EGL offer: for each kind of window that the X server has
// and that images can be put into, with and without alpha, a second buffer, depth and samples. What is drawn
// lies on the GL server, which can have all of these.
#pragma once

#include <X11/Xlib.h>
#include <X11/Xutil.h>

namespace understudy::interceptor {

struct RemoteConfig {
  int id;  ///< GLX_FBCONFIG_ID, EGL_CONFIG_ID: from 1
  int screen;
  VisualID visual;   ///< 0: without an X server, for pbuffers alone
  int visual_depth;  ///< 24, or 32 with an alpha that the screen shows; 0 without one
  int alpha;         ///< 0 or 8 bits
  int double_buffered;
  int depth;
  int stencil;
  int samples;
};

/// Of the screen (or of none: `display` null), best first; null and 0 where the server has no TrueColor visual
/// of 24 or 32 bits. They live as long as the process.
const RemoteConfig* remote_configs(Display* display, int screen, int* count);

/// As XGetVisualInfo gives it, for the application to XFree; null when the server has it no more.
XVisualInfo* visual_of(Display* display, const RemoteConfig& config);

}  // namespace understudy::interceptor
