// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/classification/texel_inputs.h"

#include <vector>

#include "spu/volume/pipeline/block_members.h"
#include "spu/volume/texture/value_range.h"

namespace understudy::spu {

VerificationSchedule::Effect effect_on_samples(const TextureDescription& texture,
                                               const std::array<float, 2>& range, int entries,
                                               VerificationSchedule::Effect foreseen) {
  return may_lie_between_entries(texture, range, entries) ? VerificationSchedule::Effect::unknown : foreseen;
}

void append_texels(std::uint64_t version, VerificationSchedule::Effect effect,
                   VerificationSchedule::Inputs& inputs) {
  std::vector<float> parts;
  append_exactly(version, parts);
  for (const float part : parts) inputs.push_back({part, effect});
}

}  // namespace understudy::spu
