// SPDX-License-Identifier: Apache-2.0
// Volumes of colours, which the application has classified itself: the map from a texel's colour to a
// fragment's.
#pragma once

#include "spu/volume/classification/probe_bench.h"

namespace understudy::spu {

/// Linear, or a refusal.
ProbeFinding probe_map(ProbeBench& bench, const GlContext& context, const Pipeline& pipeline,
                       const TextureDescription& texture, const FragmentInputs& fragment);

}  // namespace understudy::spu
