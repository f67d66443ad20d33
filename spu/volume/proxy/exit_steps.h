// SPDX-License-Identifier: Apache-2.0
// Programs that march from the back of the volume towards the eye: their samples lie on steps counted from the
// exit of a ray. Nodes count from the entry, so every pixel's ray gets an offset of its own.
#pragma once

#include "spu/volume/proxy/box.h"
#include "spu/volume/proxy/field_probe.h"
#include "volume/rect.h"
#include "volume/sampling.h"

namespace understudy::spu {

/// Whether nodes can place such samples. False for steps that are divided evenly or counted ahead, and if the
/// first sample lies a whole step from the exit: nodes would take one more, at the exit itself.
bool may_be_counted_from_exit(const volume::RaySteps& steps);

/// Returns `steps`, which must not be divided, as counted from the exits of the rays through the pixels of
/// `rect`.
volume::RaySteps counted_from_exit(const volume::RaySteps& steps, const RaysThroughBox& rays,
                                   const volume::Rect& viewport, const volume::Rect& rect);

/// Likewise for the application's whole viewport.
volume::RaySteps counted_from_exit(const volume::RaySteps& steps, const RaysThroughBox& rays,
                                   const FieldProbe& probe);

}  // namespace understudy::spu
