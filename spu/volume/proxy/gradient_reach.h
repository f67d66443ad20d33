// SPDX-License-Identifier: Apache-2.0
// How far a program's gradients look from a sample, measured by the light that they make.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "spu/volume/proxy/slope_probe.h"
#include "volume/light.h"

namespace understudy::spu {

/// In texels of the volume along `axis`; null where the ray does not show it.
std::optional<double> gradient_reach_along(SlopeProbe& slopes, const LitRay& ray, const volume::Light& light,
                                           std::size_t axis);

/// In texels of the volume along each axis; axes that the ray does not show look as far as the others. Null:
/// nearer or farther than is recognised (up to eight texels).
std::optional<std::array<double, 3>> gradient_reach(SlopeProbe& slopes, const LitRay& ray,
                                                    const volume::Light& light);

}  // namespace understudy::spu
