// SPDX-License-Identifier: Apache-2.0
// A connection of our own to the X server, beside the application's: its errors arrive as events that may be
// ignored (a window may vanish at any moment), and images can be shown whatever the application's threads do
// with their connection.
#pragma once

#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include "interceptor/core.h"

namespace understudy::interceptor {

/// The Xlib functions that remote GLX and EGL need.
struct Xlib {
  decltype(&XGetVisualInfo) get_visual_info;
  decltype(&XFree) free;
  decltype(&XSync) sync;
  decltype(&XFlush) flush;
  decltype(&XOpenDisplay) open_display;
};

/// Opens Xlib on first use; if that fails, logs it once and returns null.
const Xlib* xlib();

/// The server named by DISPLAY, opened once, for callers that name no display; null if there is none.
Display* default_display();

/// A new id, unique on the display's server, for a drawable that the server does not know; None without a
/// connection. Xlib's own (XAllocID) needs the display's lock, and a call of Xlib before the next one.
XID new_id(Display* display);

/// Stores the drawable's size; returns false if there is no such drawable.
bool extent_of(Display* display, XID drawable, int* width, int* height);

/// Returns when the image is on the screen.
void put_image(Display* display, XID drawable, const RemoteImage& image);

}  // namespace understudy::interceptor
