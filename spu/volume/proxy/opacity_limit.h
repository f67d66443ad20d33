// SPDX-License-Identifier: Apache-2.0
// Early ray termination of the application's own: at which opacity its program leaves a ray, where what it
// leaves out would be seen.
#pragma once

#include "spu/volume/proxy/box.h"
#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/march.h"

namespace understudy::spu {

/// Gives `march`, which has its table and `steps`, the opacity behind which no sample is added: 1 where there
/// is none, none below 0.9995, or samples are not composed by over. Beyond that, what a ray leaves out cannot
/// be seen.
void take_opacity_limit(const MarchContext& measured, const volume::RaySteps& steps, FieldProbe& probe,
                        const RaysThroughBox& rays, March& march);

}  // namespace understudy::spu
