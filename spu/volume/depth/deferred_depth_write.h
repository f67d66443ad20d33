// SPDX-License-Identifier: Apache-2.0
// The depth that slices write, and that programs rarely read.
//
// Many viewers leave depth writes enabled while they blend slices. Drawing the slices again for their depth
// alone would cost almost as much as the image. The first frame of a volume therefore draws it (the run is
// replayed with colour masked), and the depth is watched until it is cleared: if no draw with a depth test into
// its framebuffer, no read of depth and no copy occurs before, the depth is deferred from then on. If a later
// frame reads it after all, every frame after that one draws it at once.
//
// Binding another framebuffer does not count as a read, unless the depth is a texture, which may be sampled
// then: toolkits (Qt's QOpenGLWidget) switch framebuffers in every frame.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

class Run;

/// Replays `run` into the depth buffer only.
void write_depth(const DispatchTable& gl, const Run& run);

/// Fills the watching slots, each of which first checks whether the call reads depth.
void fill_depth_deferred_slots(DispatchTable& table);

}  // namespace understudy::spu
