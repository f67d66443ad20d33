// SPDX-License-Identifier: Apache-2.0
// Steps that one view does not tell. Under a parallel camera all rays have one direction, in which steps of one
// length in texels, in the world and in texture space are as many; in another direction they are not.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "spu/volume/proxy/step_fit.h"
#include "volume/sampling.h"

namespace understudy::spu {

/// A way through the box, and how many steps it took when it was measured.
struct MeasuredWay {
  volume::Vec3 way{};
  double steps = 0;
};

/// Whether steps of this metric make as many of each way, to a third of a step.
bool count_as_measured(const std::array<double, 9>& metric, std::span<const MeasuredWay> ways);

/// Of fits that explain this view those that count as earlier ones did; all of them where none does, as steps
/// may be others now.
std::vector<StepFit> that_count_as_measured(std::vector<StepFit> fits, std::span<const MeasuredWay> ways);

/// Whether steps of both are as long as each other in every direction, but for one factor.
bool of_one_shape(const std::array<double, 9>& one, const std::array<double, 9>& other);

/// Whether a way tells `metrics` apart, by a quarter of a step or more. They counted alike when `steps` were
/// measured by the first of them; `steps` may have become longer or shorter.
bool tells_apart(std::span<const std::array<double, 9>> metrics, const volume::RaySteps& steps,
                 const volume::Vec3& way);

}  // namespace understudy::spu
