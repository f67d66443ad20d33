// SPDX-License-Identifier: Apache-2.0
// Pre-integrated slices: colours of segments, by the values at their two ends (Engel, Kraus, Ertl 2001).
#pragma once

#include "spu/volume/classification/probe_bench.h"

namespace understudy::spu {

/// The pre-integration table that explains the colours, where input `end` addresses the volume a second time;
/// null when they depend on more.
std::optional<Probed> probe_segments(ProbeBench& bench, const GlContext& context, const Pipeline& pipeline,
                                     const TextureDescription& texture, const FragmentInputs& fragment,
                                     const std::array<float, 2>& range, std::size_t end);

}  // namespace understudy::spu
