// SPDX-License-Identifier: Apache-2.0
// Pre-integrated slices: the colours of segments by the values at their two ends (Engel, Kraus, Ertl 2001).
#pragma once

#include "spu/volume/classification/probe_bench.h"

namespace understudy::spu {

/// Returns the pre-integration table that explains the colours if input `end` addresses the volume a second
/// time; null if they depend on more.
std::optional<Probed> probe_segments(ProbeBench& bench, const GlContext& context, const Pipeline& pipeline,
                                     const TextureDescription& texture, const FragmentInputs& fragment,
                                     const std::array<float, 2>& range, std::size_t end);

}  // namespace understudy::spu
