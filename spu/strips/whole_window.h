// A window of which a process has but a strip becomes whole.
#pragma once

#include "dispatch/table.h"
#include "spu/player/window_system.h"

namespace understudy::spu {

/// Whether complete_window() can give the depth and the stencil of the window that is drawn into.
bool depth_can_be_copied(const DispatchTable& gl);

/// Reads the window through `gl`, which is to give all of it, and draws colour, depth and stencil into it
/// again. Nothing else of the context is different afterwards.
void complete_window(const DispatchTable& gl, Extent2D extent);

}  // namespace understudy::spu
