// SPDX-License-Identifier: Apache-2.0
// The steps of a ray caster that shows the largest or the least value of every ray. In a field that rises along
// an axis, this is the value of the first or of the last sample, and its colour shows where that sample lies.
#pragma once

#include <span>
#include <vector>

#include "spu/volume/proxy/coordinate_space.h"
#include "spu/volume/proxy/field_probe.h"
#include "volume/classification.h"
#include "volume/sampling.h"

namespace understudy::spu {

/// Where the first and the last sample of a ray lie, as fractions of its path.
struct RayEnds {
  volume::Vec3 way{};
  double first = 0;
  double last = 1;
  int x = 0;  ///< the pixel, in the window
  int y = 0;
};

/// Returns the ends of some rays all over the box. `table`: the colours of extreme values. Empty if colours do
/// not determine values.
std::vector<RayEnds> ends_of_rays(const MarchContext& measured, FieldProbe& probe,
                                  const volume::TransferFunction& table, const ProxyBox& box);

/// Returns constant steps on which the samples lie: of one length in texels, in the world that the camera
/// shows, or in texture space.
std::vector<volume::RaySteps> steps_of(const std::vector<RayEnds>& ends, const MarchContext& measured,
                                       const FieldProbe& probe, const ProxyBox& box);

/// Whether nearly all of the samples lie where `steps` places them.
bool lie_on(const volume::RaySteps& steps, std::span<const RayEnds> ends);

}  // namespace understudy::spu
