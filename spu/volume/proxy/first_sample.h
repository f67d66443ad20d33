// SPDX-License-Identifier: Apache-2.0
// Whether rays that are too short for a sample have one nevertheless.
//
// VTK looks for the end of a ray after each sample: a ray that noise begins behind its own end still has one,
// with what the texture's wrapping makes of the field there. At the silhouette of the box that is a rim as wide
// as steps are long, ten texels and more while somebody turns a volume in ParaView.
#pragma once

#include <vector>

#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/march.h"

namespace understudy::spu {

/// Whether rays that `rule` gives no sample have their first one nevertheless (volume::RaySteps::at_least_one).
/// `values`: all over the range. False where no ray in view is that short; not tested where the program puts
/// its rays over a background of its own. Afterwards `probe` shows the program's own noise.
bool takes_first_sample_anyway(const MarchContext& measured, FieldProbe& probe, const RaysThroughBox& rays,
                               const March& march, const volume::RaySteps& rule,
                               const std::vector<float>& values);

}  // namespace understudy::spu
