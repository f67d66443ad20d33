// SPDX-License-Identifier: Apache-2.0
// Ray casters that show the mean of a ray's samples: detects them, and counts the samples of a ray. With n
// samples, one that differs changes the mean by one n-th of its difference.
#pragma once

#include <vector>

#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/march.h"
#include "spu/volume/proxy/step_fit.h"

namespace understudy::spu {

/// For a ray whose colour does not depend on its length: whether fields of two values show a mixture of both.
/// (An extreme shows the colour of one of them.) `colours` are those of constant fields of `values`.
bool shows_mean(FieldProbe& probe, const ProxyBox& box, const std::vector<float>& values,
                const std::vector<volume::Rgba>& colours);

/// Returns rays all over the box with their numbers of samples, for a mean of colours or of values; empty if
/// colours do not determine them.
std::vector<CountedRay> counted_by_means(FieldProbe& probe, const ProxyBox& box, Mean mean,
                                         const std::vector<float>& values,
                                         const std::vector<volume::Rgba>& colours);

/// Whether nearly all of these rays have as many samples as `steps` gives them.
bool have_as_many(const std::vector<CountedRay>& rays, const volume::RaySteps& steps);

}  // namespace understudy::spu
