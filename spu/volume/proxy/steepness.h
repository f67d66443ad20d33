// SPDX-License-Identifier: Apache-2.0
// Whether samples look the same however steep their slope is: gradient opacity, and light on steep slopes
// alone, are no functions of the angle between normal and ray.
#pragma once

#include <cstddef>

#include "spu/volume/proxy/light_space.h"
#include "spu/volume/proxy/slope_probe.h"
#include "volume/light.h"
#include "volume/sampling.h"

namespace understudy::spu {

/// Whether neither opacity nor colour depend on how steep a slope is, but for what values on the ray differ by:
/// of slopes as steep as those by which light is measured, gentler and steeper ones. The ray enters by a face
/// across `axis_of_entry`.
bool is_the_same_for_any_steepness(SlopeProbe& slopes, const LitRay& ray, const LightSpace& directions,
                                   std::size_t axis_of_entry);

/// The same where `light` is known, whose guard makes gentle slopes look otherwise.
bool is_lit_as_said_for_any_steepness(SlopeProbe& slopes, const LitRay& ray, const volume::RaySteps& steps,
                                      const volume::Light& light, std::size_t axis_of_entry);

}  // namespace understudy::spu
