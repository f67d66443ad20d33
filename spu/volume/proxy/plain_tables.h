// SPDX-License-Identifier: Apache-2.0
// A ray under tables of one colour in place of the program's own: light can then be measured on slopes as steep
// as one likes, in colours that tell diffuse light from highlights.
#pragma once

#include <optional>

#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/march.h"
#include "spu/volume/proxy/slope_probe.h"

namespace understudy::spu {

struct RayUnderPlainTables {
  LitRay ray;
  PlainTables tables;
};

/// The ray with tables for each of its values; none where the program looks up by samples neither one table of
/// 1 or 2 dimensions nor two, of colours and of opacities, or where colours depend on more than them.
std::optional<RayUnderPlainTables> under_plain_tables(const MarchContext& measured, FieldProbe& probe,
                                                      const March& march, const LitRay& ray);

/// The ray with one value, under the tables of `march`, which has some; none where they are not there any more,
/// or show nothing translucent.
std::optional<LitRay> under_known_tables(const MarchContext& measured, FieldProbe& probe, const March& march,
                                         const LitRay& ray);

}  // namespace understudy::spu
