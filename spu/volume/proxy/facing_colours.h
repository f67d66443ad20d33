// SPDX-License-Identifier: Apache-2.0
// The colours of samples where constant fields are black: a material that reflects no ambient light shows
// nothing without a gradient. Slopes perpendicular to the face by which a ray enters show its colours.
#pragma once

#include <cstddef>
#include <vector>

#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/march.h"

namespace understudy::spu {

/// Returns the axis perpendicular to the face by which a ray enters the box.
std::size_t axis_of_entry(const volume::Box& region, const WayThroughBox& way);

/// Writes the colours to the march's table, whose opacities and steps are known. If `march.light` has a
/// response, they are the base colours that it lights; otherwise the colours as shown, by which the light will
/// be measured. False if no ray shows them, or if some are too bright to determine because the light clamps
/// them.
bool take_facing_colours(const MarchContext& measured, FieldProbe& probe, const ProxyBox& box, March& march);

/// Whether slopes of these values look as `march`, whose light has a response, predicts.
bool shows_facing_colours(const MarchContext& measured, FieldProbe& probe, const ProxyBox& box,
                          const March& march, const std::vector<float>& values);

}  // namespace understudy::spu
