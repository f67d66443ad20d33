// SPDX-License-Identifier: Apache-2.0
// How many steps of one length make up a unit, told by rays whose first and last samples are seen and not
// counted: between these two lies a whole number of steps on every ray.
#pragma once

#include <optional>
#include <span>

namespace understudy::spu {

/// Stretches of one ray, in the unit.
struct SampledWay {
  double whole = 0;    ///< through the box
  double sampled = 0;  ///< from the first sample to the last
  double behind = 0;   ///< from the last sample to the end
};

/// Steps in a unit, to within a 50th of a step of the longest way. Null where no number makes the sampled
/// stretches whole, or where steps are too short for colours to tell.
std::optional<double> step_density(std::span<const SampledWay> ways);

}  // namespace understudy::spu
