// SPDX-License-Identifier: Apache-2.0
// Programs that march from the back of the volume towards the eye: their samples lie on steps from where a ray
// leaves the box. Nodes count from where it enters, so every pixel's ray gets an offset of its own.
#pragma once

#include "spu/volume/proxy/box.h"
#include "spu/volume/proxy/field_probe.h"
#include "volume/rect.h"
#include "volume/sampling.h"

namespace understudy::spu {

/// Not where they are divided evenly, or where the first sample lies a whole step from the exit: nodes would
/// take one more, at the exit itself.
bool may_be_counted_from_exit(const volume::RaySteps& steps);

/// The places of `steps`, which are not divided, counted from the exits of the rays through the pixels of
/// `rect`.
volume::RaySteps counted_from_exit(const volume::RaySteps& steps, const RaysThroughBox& rays,
                                   const volume::Rect& viewport, const volume::Rect& rect);

/// The same all over the application's viewport.
volume::RaySteps counted_from_exit(const volume::RaySteps& steps, const RaysThroughBox& rays,
                                   const FieldProbe& probe);

}  // namespace understudy::spu
