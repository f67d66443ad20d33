// SPDX-License-Identifier: Apache-2.0
// How many steps of one length make up a unit of length, for rays whose first and last samples are located and
// not counted: between these two lies a whole number of steps on every ray.
#pragma once

#include <optional>
#include <span>

namespace understudy::spu {

/// Lengths along one ray, in the unit.
struct SampledWay {
  double whole = 0;    ///< through the box
  double sampled = 0;  ///< from the first sample to the last
  double behind = 0;   ///< from the last sample to the end
};

/// Returns the steps in a unit, to within a 50th of a step on the longest path. Null if no number makes the
/// sampled lengths whole, or if steps are too short for colours to resolve.
std::optional<double> step_density(std::span<const SampledWay> ways);

}  // namespace understudy::spu
