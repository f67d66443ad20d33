// SPDX-License-Identifier: Apache-2.0
// Early ray termination by the application: the opacity at which its program leaves a ray, where what it omits
// would be visible.
#pragma once

#include "spu/volume/proxy/box.h"
#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/march.h"

namespace understudy::spu {

/// Sets the opacity beyond which `march`, which has its table and `steps`, adds no sample. 1 if there is none
/// from 0.5 to 0.9995, or if samples are not composed by over. Beyond 0.9995, what a ray omits is invisible.
void take_opacity_limit(const MarchContext& measured, const volume::RaySteps& steps, FieldProbe& probe,
                        const RaysThroughBox& rays, March& march);

}  // namespace understudy::spu
