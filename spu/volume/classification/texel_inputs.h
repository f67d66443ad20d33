// SPDX-License-Identifier: Apache-2.0
// The texels of a volume among what an image depends on.
#pragma once

#include <array>
#include <cstdint>

#include "spu/volume/texture/texels.h"
#include "spu/volume/verification/schedule.h"

namespace understudy::spu {

/// Returns the effect of a change of what samples show: `foreseen` if they can have no value that a measured
/// table of `entries` entries over `range` lacks, otherwise unknown.
VerificationSchedule::Effect effect_on_samples(const TextureDescription& texture,
                                               const std::array<float, 2>& range, int entries,
                                               VerificationSchedule::Effect foreseen);

/// Appends a number that is another one after the texels have changed.
void append_texels(std::uint64_t version, VerificationSchedule::Effect effect,
                   VerificationSchedule::Inputs& inputs);

}  // namespace understudy::spu
