// SPDX-License-Identifier: Apache-2.0
// Whether samples look the same however steep their slope is: gradient opacity, and light on steep slopes
// alone, are not functions of the angle between normal and ray.
#pragma once

#include <cstddef>

#include "spu/volume/proxy/light_space.h"
#include "spu/volume/proxy/slope_probe.h"
#include "volume/light.h"
#include "volume/sampling.h"

namespace understudy::spu {

/// Whether neither opacity nor colour depend on how steep a slope is, up to what values on the ray differ by.
/// Compares slopes as steep as those by which light is measured with gentler and steeper ones. The ray enters
/// by a face perpendicular to `axis_of_entry`.
bool is_the_same_for_any_steepness(SlopeProbe& slopes, const LitRay& ray, const LightSpace& directions,
                                   std::size_t axis_of_entry);

/// Likewise for a known `light`, whose guard makes gentle slopes look different.
bool is_lit_as_said_for_any_steepness(SlopeProbe& slopes, const LitRay& ray, const volume::RaySteps& steps,
                                      const volume::Light& light, std::size_t axis_of_entry);

}  // namespace understudy::spu
