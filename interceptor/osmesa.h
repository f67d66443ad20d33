// SPDX-License-Identifier: Apache-2.0
// OSMesa: Mesa's library for drawing into an array of the application's, without a window system. It holds a
// whole OpenGL of its own, and has no swap: an image is complete when the application says glFinish or
// glFlush.
#pragma once

#include "dispatch/table.h"

namespace understudy::interceptor {

/// Has glFinish and glFlush of OSMesa's functions tell the core, after they are done, that a frame ends.
void end_frames_of_osmesa(spu::DispatchTable& functions);

}  // namespace understudy::interceptor
