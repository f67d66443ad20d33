// SPDX-License-Identifier: Apache-2.0
// glXUseXFont without a driver: display lists made of the glyphs of an X server's font.
#pragma once

#include <X11/Xlib.h>

#include "dispatch/table.h"

namespace understudy::interceptor {

/// Makes one display list of each of `count` characters from `first` on, named from `list` on, by `gl`, the
/// table that the application's calls go through. Lists of characters that the font lacks are empty; no list is
/// made where the server has no such font.
void make_lists_of_font(const spu::DispatchTable& gl, Display* display, Font font, int first, int count,
                        int list);

}  // namespace understudy::interceptor
