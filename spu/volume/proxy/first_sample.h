// SPDX-License-Identifier: Apache-2.0
// Whether rays that are too short for a sample have one nevertheless.
//
// VTK checks for the end of a ray after each sample: a ray that noise starts beyond its own end still has one,
// of the value that the texture's wrapping yields there. At the silhouette of the box, this makes a rim as wide
// as steps are long, ten texels and more while somebody turns a volume in ParaView.
#pragma once

#include <vector>

#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/march.h"

namespace understudy::spu {

/// Whether rays to which `rule` gives no sample have their first one nevertheless
/// (volume::RaySteps::at_least_one). `values`: spread over the range. False if no ray in view is that short,
/// and, untested, if the program puts its rays over a background of its own. Afterwards `probe` shows the
/// program's own noise.
bool takes_first_sample_anyway(const MarchContext& measured, FieldProbe& probe, const RaysThroughBox& rays,
                               const March& march, const volume::RaySteps& rule,
                               const std::vector<float>& values);

}  // namespace understudy::spu
