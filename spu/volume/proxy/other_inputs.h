// SPDX-License-Identifier: Apache-2.0
// What a ray caster's image depends on beside the uniforms of its fragment stage: uniforms of the vertex stage,
// members of uniform buffers, and what vertices hand on that decides about samples (how far one lies from a
// plane). What places samples is seen where the volume's box is, and is not among it.
#pragma once

#include "spu/volume/proxy/march_inputs.h"

namespace understudy::spu {

/// Appends vectors to `inputs.varying`: as many, and as long, for every image of one link of a program.
void append_other_inputs(const MarchContext& measured, const ProgramFindings& says, MarchInputs& inputs);

}  // namespace understudy::spu
