// SPDX-License-Identifier: Apache-2.0
// What keeps a program's normals from a division by zero, measured by light on slopes from the gentlest to the
// steepest.
#pragma once

#include <optional>

#include "spu/volume/proxy/light_space.h"
#include "spu/volume/proxy/slope_probe.h"
#include "volume/light.h"
#include "volume/sampling.h"

namespace understudy::spu {

/// Returns `light`, which was measured on the steepest slopes of a ray under plain tables, with the guard that
/// explains gentler ones; null if none does: then colour or opacity depend on the steepness in another way.
std::optional<volume::Light> with_normal_guard(SlopeProbe& slopes, const LitRay& plain,
                                               const volume::RaySteps& steps, const volume::Light& light);

}  // namespace understudy::spu
