// SPDX-License-Identifier: Apache-2.0
// What the measurement of a ray caster depends on.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "spu/track/share_group.h"
#include "spu/volume/proxy/coordinate_space.h"

namespace understudy::spu {

/// What a march was measured under. While `fixed` stays, and a look at a few rays says so, it holds: the camera
/// is among the inputs that vary.
struct MarchInputs {
  std::vector<float> fixed;
  std::vector<std::size_t>
      tables;  ///< of `fixed`, names and contents of tables that samples address: measured anew
  std::vector<float> varying;
  bool operator==(const MarchInputs&) const = default;
};

/// `tables_of_samples` names samplers (program::RayFinding).
MarchInputs march_inputs(const MarchContext& measured, const ShareGroup& group,
                         std::span<const std::string> tables_of_samples);

}  // namespace understudy::spu
