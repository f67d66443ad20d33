// SPDX-License-Identifier: Apache-2.0
// Whether a program clamps lit colours, determined from values over the whole range.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "spu/volume/proxy/slope_probe.h"
#include "volume/light.h"
#include "volume/sampling.h"

namespace understudy::spu {

/// Returns `light`, which does not clamp, the same light with clamped colours, or both: each one that explains
/// what values on a ray show, unless the other explains it clearly better. Empty if neither does. The ray
/// enters by a face perpendicular to `axis_of_entry`.
std::vector<volume::Light> without_and_with_clamp(SlopeProbe& slopes, const LitRay& ray,
                                                  const volume::RaySteps& steps, std::size_t axis_of_entry,
                                                  const volume::Light& light,
                                                  const std::array<float, 2>& range);

}  // namespace understudy::spu
