// SPDX-License-Identifier: Apache-2.0
// The colours of samples where even fields are black: a material that reflects no ambient light shows nothing
// where there is no gradient. Slopes across the face by which a ray enters show its colours.
#pragma once

#include <cstddef>
#include <vector>

#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/march.h"

namespace understudy::spu {

/// By which of the box's faces a ray enters: the axis across it.
std::size_t axis_of_entry(const volume::Box& region, const WayThroughBox& way);

/// Into the march's table, whose opacities and steps are known. Where `march.light` has a response, they are
/// what that makes these slopes of; otherwise it is to be measured by them. False where some are too bright to
/// tell: the light clamps them.
bool take_facing_colours(const MarchContext& measured, FieldProbe& probe, const ProxyBox& box, March& march);

/// Whether slopes of these values look as `march`, which has a response, says.
bool shows_facing_colours(const MarchContext& measured, FieldProbe& probe, const ProxyBox& box,
                          const March& march, const std::vector<float>& values);

}  // namespace understudy::spu
