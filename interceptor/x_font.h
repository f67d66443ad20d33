// SPDX-License-Identifier: Apache-2.0
// glXUseXFont without a driver: display lists of the glyphs of an X server's font.
#pragma once

#include <X11/Xlib.h>

#include "dispatch/table.h"

namespace understudy::interceptor {

/// Makes one display list for each of `count` characters from `first` on, with names from `list` on. `gl` is
/// the table that the application's calls go through. Characters that the font lacks get empty lists; if the
/// server has no such font, no list is made.
void make_lists_of_font(const spu::DispatchTable& gl, Display* display, Font font, int first, int count,
                        int list);

}  // namespace understudy::interceptor
