// SPDX-License-Identifier: Apache-2.0
// A texture of noise by which rays begin, of ray casters that show the largest or the least value of every ray:
// their samples cannot be counted, but rising fields show where the first one lies (extreme_steps.h).
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
  std::vector<volume::RaySteps> steps;  ///< of rays that begin at the texture's zero
};

/// The texture that moves the first sample of each ray by its own number at the ray's pixel, where there is
/// one. Afterwards `probe` shows the program's own textures.
std::optional<ExtremeJitter> find_extreme_jitter(const MarchContext& measured, FieldProbe& probe,
                                                 const volume::TransferFunction& table, const ProxyBox& box);

/// Whether nearly all rays begin by the offsets of `steps`. Only rays tell that have samples wherever they
/// begin; true where there are none.
bool begin_as_said(const volume::RaySteps& steps, std::vector<RayEnds> ends);

}  // namespace understudy::spu
