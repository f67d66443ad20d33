// SPDX-License-Identifier: Apache-2.0
// The steps of a ray caster that shows the largest or the least value of every ray: of a field that rises along
// an axis that is the first sample or the last, and its colour tells where it lies.
#pragma once

#include <span>
#include <vector>

#include "spu/volume/proxy/coordinate_space.h"
#include "spu/volume/proxy/field_probe.h"
#include "volume/classification.h"
#include "volume/sampling.h"

namespace understudy::spu {

/// Where the first and the last sample of a ray lie, as parts of its way.
struct RayEnds {
  volume::Vec3 way{};
  double first = 0;
  double last = 1;
  int x = 0;  ///< the pixel, in the window
  int y = 0;
};

/// Of some rays all over the box. `table`: the colours of extreme values. None where colours do not tell values
/// apart.
std::vector<RayEnds> ends_of_rays(const MarchContext& measured, FieldProbe& probe,
                                  const volume::TransferFunction& table, const ProxyBox& box);

/// Constant steps on which they lie: of so many texels, of one length in the world that the camera shows, or of
/// one length in texture space.
std::vector<volume::RaySteps> steps_of(const std::vector<RayEnds>& ends, const MarchContext& measured,
                                       const FieldProbe& probe, const ProxyBox& box);

/// Whether nearly all of them lie where `steps` says.
bool lie_on(const volume::RaySteps& steps, std::span<const RayEnds> ends);

}  // namespace understudy::spu
