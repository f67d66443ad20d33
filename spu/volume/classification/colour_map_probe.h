// SPDX-License-Identifier: Apache-2.0
// Probes volumes of colours, which the application has classified itself: measures the map from the colour of a
// texel to that of a fragment.
#pragma once

#include "spu/volume/classification/probe_bench.h"

namespace understudy::spu {

/// Returns the map if it is linear, otherwise a refusal.
ProbeFinding probe_map(ProbeBench& bench, const GlContext& context, const Pipeline& pipeline,
                       const TextureDescription& texture, const FragmentInputs& fragment);

}  // namespace understudy::spu
