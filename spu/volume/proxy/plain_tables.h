// SPDX-License-Identifier: Apache-2.0
// A ray under tables of one colour in place of the program's own: light can then be measured on slopes as steep
// as one likes, in colours that tell diffuse light from highlights.
#pragma once

#include <optional>

#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/march.h"
#include "spu/volume/proxy/slope_probe.h"

namespace understudy::spu {

/// The ray with a table for each of its values; none where the program has not one table alone, of 1 or 2
/// dimensions, that is looked up by samples, or where colours depend on more than it.
std::optional<LitRay> under_plain_tables(const MarchContext& measured, FieldProbe& probe, const March& march,
                                         const LitRay& ray);

}  // namespace understudy::spu
