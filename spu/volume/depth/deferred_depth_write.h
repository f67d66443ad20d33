// SPDX-License-Identifier: Apache-2.0
// The depth that slices write, and that usually nobody looks at.
//
// Many viewers leave depth writes on while they blend slices. Drawing the slices once more for their depth
// alone would cost almost what the image did. So the first frame of a volume draws it (the run is replayed with
// colour masked), and is watched until its depth is cleared: if no draw with a depth test into its framebuffer,
// no read of depth and no copy comes in between, it is deferred from then on. Should a later frame look at it
// after all, every frame after that one draws it at once.
//
// Binding another framebuffer is no look, unless the depth is a texture, which may be sampled then: toolkits
// (Qt's QOpenGLWidget) switch between framebuffers in every frame.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

class Run;

/// Replays `run` into the depth buffer only.
void write_depth(const DispatchTable& gl, const Run& run);

/// The watching slots, each of which first asks whether the call looks at depth.
void fill_depth_deferred_slots(DispatchTable& table);

}  // namespace understudy::spu
