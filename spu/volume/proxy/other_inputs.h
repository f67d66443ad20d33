// SPDX-License-Identifier: Apache-2.0
// What a ray caster's image depends on beside the uniforms of its fragment stage: uniforms of the vertex stage,
// members of uniform buffers, and all that vertices hand on but the place in the volume, which is measured in
// every image with the box.
#pragma once

#include "spu/volume/proxy/march_inputs.h"

namespace understudy::spu {

/// Appends vectors to `inputs.varying`. `space` is where samples lie.
void append_other_inputs(const MarchContext& measured, const CoordinateSpace& space,
                         const ProgramFindings& says, MarchInputs& inputs);

}  // namespace understudy::spu
