// SPDX-License-Identifier: Apache-2.0
// Whether a program clamps what light makes of a colour, told by values all over the range.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "spu/volume/proxy/slope_probe.h"
#include "volume/light.h"
#include "volume/sampling.h"

namespace understudy::spu {

/// `light`, which clamps nothing, without and with clamped colours, as far as it explains what values on a ray
/// show and the other does so no better; none where neither does. The ray enters by a face across
/// `axis_of_entry`.
std::vector<volume::Light> without_and_with_clamp(SlopeProbe& slopes, const LitRay& ray,
                                                  const volume::RaySteps& steps, std::size_t axis_of_entry,
                                                  const volume::Light& light,
                                                  const std::array<float, 2>& range);

}  // namespace understudy::spu
