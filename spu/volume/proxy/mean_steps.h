// SPDX-License-Identifier: Apache-2.0
// Ray casters that show the mean of a ray's samples: whether they do, and how many samples a ray has. Of n
// samples one that differs changes the mean by one n-th of what it differs by.
#pragma once

#include <vector>

#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/march.h"
#include "spu/volume/proxy/step_fit.h"

namespace understudy::spu {

/// Of a ray whose colour does not depend on its length, by `colours` of fields of `values`, each of one value:
/// whether fields of two values show a mixture of both. An extreme is the colour of one of them.
bool shows_mean(FieldProbe& probe, const ProxyBox& box, const std::vector<float>& values,
                const std::vector<volume::Rgba>& colours);

/// Rays all over the box with the number of their samples, where the mean is of colours or of values; none
/// where colours do not tell.
std::vector<CountedRay> counted_by_means(FieldProbe& probe, const ProxyBox& box, Mean mean,
                                         const std::vector<float>& values,
                                         const std::vector<volume::Rgba>& colours);

/// Whether nearly all of these rays have as many samples as `steps` says.
bool have_as_many(const std::vector<CountedRay>& rays, const volume::RaySteps& steps);

}  // namespace understudy::spu
