// SPDX-License-Identifier: Apache-2.0
// OSMesa: Mesa's library for drawing into an array of the application, without a window system. It contains a
// complete OpenGL and has no swap: an image is complete when the application calls glFinish or glFlush.
#pragma once

#include "dispatch/table.h"

namespace understudy::interceptor {

/// Replaces glFinish and glFlush in OSMesa's functions by wrappers that then tell the core that a frame ended.
void end_frames_of_osmesa(spu::DispatchTable& functions);

}  // namespace understudy::interceptor
