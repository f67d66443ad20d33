// SPDX-License-Identifier: Apache-2.0
// The colour of one sample of every value, measured on rays of few samples.
#pragma once

#include <optional>

#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/march.h"

namespace understudy::spu {

/// Into the march's table, whose steps are those of `rule`. Several rays are asked, from one sample on: the
/// longest that is not opaque tells best, because some programs keep a ray's opacity above a floor.
std::optional<Refusal> measure_table(const MarchContext& measured, FieldProbe& probe,
                                     const RaysThroughBox& rays, const volume::RaySteps& rule, March& march);

/// Of the march's table, the value whose field lets most nearly half of the light through a ray that goes
/// `way`; null: none lets a part through.
std::optional<float> half_seen_value(const March& march, const volume::Vec3& way);

}  // namespace understudy::spu
