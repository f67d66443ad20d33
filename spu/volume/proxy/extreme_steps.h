// SPDX-License-Identifier: Apache-2.0
// The steps of a ray caster that shows the largest or the least value of every ray: of a field that rises along
// an axis that is the first sample or the last, and its colour tells where it lies.
#pragma once

#include <optional>
#include <vector>

#include "spu/volume/proxy/coordinate_space.h"
#include "spu/volume/proxy/field_probe.h"
#include "volume/classification.h"
#include "volume/sampling.h"

namespace understudy::spu {

/// Constant steps: of so many texels, of one length in the world that the camera shows, or of one length in
/// texture space; each that samples lie on. `table`: the colours of extreme values. None where colours do not
/// tell values apart, or samples do not lie on such steps.
std::vector<volume::RaySteps> extreme_steps(const MarchContext& measured, FieldProbe& probe,
                                            const volume::TransferFunction& table, const ProxyBox& box);

/// Whether the samples of nearly all rays lie on `steps`; empty where colours do not tell values apart.
std::optional<bool> extremes_lie_on(const volume::RaySteps& steps, const MarchContext& measured,
                                    FieldProbe& probe, const volume::TransferFunction& table,
                                    const ProxyBox& box);

}  // namespace understudy::spu
