// SPDX-License-Identifier: Apache-2.0
// Volumes of scalars: measures the colour of every value, a transfer function, and the fog over it.
#pragma once

#include "spu/volume/classification/probe_bench.h"

namespace understudy::spu {

/// `range` is the interval of values that the table covers.
ProbeFinding probe_table(ProbeBench& bench, const GlContext& context, const Pipeline& pipeline,
                         const TextureDescription& texture, const FragmentInputs& fragment,
                         const std::array<float, 2>& range);

}  // namespace understudy::spu
