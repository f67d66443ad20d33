// SPDX-License-Identifier: Apache-2.0
// What keeps a program's normals from a division by zero, told by light on slopes from the gentlest to the
// steepest.
#pragma once

#include <optional>

#include "spu/volume/proxy/light_space.h"
#include "spu/volume/proxy/slope_probe.h"
#include "volume/light.h"
#include "volume/sampling.h"

namespace understudy::spu {

/// `light`, which was measured on the steepest slopes of a ray under plain tables, with the guard that explains
/// the gentler ones; null where none does: colour or opacity depend on how steep a gradient is in another way.
std::optional<volume::Light> with_normal_guard(SlopeProbe& slopes, const LitRay& plain,
                                               const volume::RaySteps& steps, const volume::Light& light);

}  // namespace understudy::spu
