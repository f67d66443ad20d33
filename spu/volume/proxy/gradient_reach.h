// SPDX-License-Identifier: Apache-2.0
// How far from a sample a program's gradients reach, measured by the light that they produce.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "spu/volume/proxy/slope_probe.h"
#include "volume/light.h"

namespace understudy::spu {

/// Whether gradients reach as far along `axis` as `light` has it; true if the ray does not show it.
bool still_reaches(SlopeProbe& slopes, const LitRay& ray, const volume::Light& light, std::size_t axis);

/// Returns the reach in texels of the volume along each axis; axes that the ray does not show get the largest
/// reach of the others. Null if a reach is outside the recognised range (0.2 to 8 texels).
std::optional<std::array<double, 3>> gradient_reach(SlopeProbe& slopes, const LitRay& ray,
                                                    const volume::Light& light);

}  // namespace understudy::spu
