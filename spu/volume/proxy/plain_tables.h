// SPDX-License-Identifier: Apache-2.0
// A ray under tables of one colour in place of the program's own: light can then be measured on slopes of any
// steepness, in colours that distinguish diffuse light from highlights.
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

/// Returns the ray with tables for each of its values. Null unless samples look up one table of 1 or 2
/// dimensions, or two, of colours and of opacities, and colours depend on nothing else.
std::optional<RayUnderPlainTables> under_plain_tables(const MarchContext& measured, FieldProbe& probe,
                                                      const March& march, const LitRay& ray);

/// Returns the ray with one value, under the plain tables of `march`, which must have some; null if the program
/// has no such tables any more, or if they show nothing translucent.
std::optional<LitRay> under_known_tables(const MarchContext& measured, FieldProbe& probe, const March& march,
                                         const LitRay& ray);

}  // namespace understudy::spu
