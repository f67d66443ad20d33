// SPDX-License-Identifier: Apache-2.0
// The noise texture that offsets the beginnings of rays, for ray casters that show the largest or the least
// value of every ray. Their samples cannot be counted, but rising fields show where the first one lies
// (extreme_steps.h).
#pragma once

#include <optional>
#include <vector>

#include "spu/volume/proxy/extreme_steps.h"
#include "spu/volume/proxy/field_probe.h"
#include "spu/volume/proxy/jitter.h"
#include "volume/classification.h"

namespace understudy::spu {

struct ExtremeJitter {
  Jitter jitter;
  std::vector<volume::RaySteps> steps;  ///< of rays at which the texture is zero
};

/// Finds the texture whose texel for a ray's pixel moves the ray's first sample; null if there is none.
/// Afterwards `probe` shows the program's own textures.
std::optional<ExtremeJitter> find_extreme_jitter(const MarchContext& measured, FieldProbe& probe,
                                                 const volume::TransferFunction& table, const ProxyBox& box);

/// Whether nearly all rays begin at the offsets of `steps`. Only rays that have samples wherever they begin are
/// checked; true if there are none.
bool begin_as_said(const volume::RaySteps& steps, std::vector<RayEnds> ends);

}  // namespace understudy::spu
