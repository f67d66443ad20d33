// SPDX-License-Identifier: Apache-2.0
// The X server, by a connection of our own beside the application's: its errors come back as events that nobody
// need handle (a window may be gone at any moment), and images may be shown whatever the application's
// threads do with theirs.
#pragma once

#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include "interceptor/core.h"

namespace understudy::interceptor {

/// Xlib's functions that stand in for GLX's use of it; null where Xlib is not to be had.
struct Xlib {
  decltype(&XGetVisualInfo) get_visual_info;
  decltype(&XFree) free;
  decltype(&XSync) sync;
  decltype(&XFlush) flush;
  decltype(&XOpenDisplay) open_display;
};

/// Opened on first use; null, said once, when it cannot be.
const Xlib* xlib();

/// The server that DISPLAY names, opened once for whoever names no display; null where there is none.
Display* default_display();

/// The drawable's size; false when there is no such drawable.
bool extent_of(Display* display, XID drawable, int* width, int* height);

/// Returns when the image is on the screen.
void put_image(Display* display, XID drawable, const RemoteImage& image);

}  // namespace understudy::interceptor
