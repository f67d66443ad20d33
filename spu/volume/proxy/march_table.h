// SPDX-License-Identifier: Apache-2.0
// The colour of one sample of every value, measured on rays of few samples.
#pragma once

#include <optional>

#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/march.h"

namespace understudy::spu {

/// Measures the march's table, for the steps of `rule`. Probes several rays, from one sample on. The longest
/// ray that is not opaque measures best, because some programs keep a ray's opacity above a floor.
std::optional<Refusal> measure_table(const MarchContext& measured, FieldProbe& probe,
                                     const RaysThroughBox& rays, const volume::RaySteps& rule, March& march);

/// Returns the value of the march's table whose constant field lets most nearly half of the light through a ray
/// along `way`; null if none is translucent.
std::optional<float> half_seen_value(const March& march, const volume::Vec3& way);

}  // namespace understudy::spu
