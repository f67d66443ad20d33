// SPDX-License-Identifier: Apache-2.0
// What the measurement of a ray caster depends on.
#pragma once

#include <vector>

#include "spu/track/share_group.h"
#include "spu/volume/proxy/coordinate_space.h"

namespace understudy::spu {

/// What a march was measured under. While `fixed` stays, and a look at a few rays says so, it holds: the camera
/// is among the inputs that vary.
struct MarchInputs {
  std::vector<float> fixed;
  std::vector<float> varying;
  bool operator==(const MarchInputs&) const = default;
};

MarchInputs march_inputs(const MarchContext& measured, const ShareGroup& group);

}  // namespace understudy::spu
