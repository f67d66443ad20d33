// SPDX-License-Identifier: Apache-2.0
// What a ray caster's image depends on beside the uniforms of its fragment stage: uniforms of the vertex stage,
// members of uniform buffers, and all varyings but the position in the volume, which is measured in every image
// with the box.
#pragma once

#include "spu/volume/proxy/march_inputs.h"

namespace understudy::spu {

/// Appends vectors to `inputs.varying`. `space` is the space of the samples.
void append_other_inputs(const MarchContext& measured, const CoordinateSpace& space,
                         const ProgramFindings& says, MarchInputs& inputs);

}  // namespace understudy::spu
