// SPDX-License-Identifier: Apache-2.0
// Steps that one view leaves open. Under a parallel camera all rays have one direction. In this direction,
// steps of one length in texels, in the world and in texture space may give the same counts; in another they do
// not.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "spu/volume/proxy/step_fit.h"
#include "volume/sampling.h"

namespace understudy::spu {

/// A path through the box, and the number of steps along it when it was measured.
struct MeasuredWay {
  volume::Vec3 way{};
  double steps = 0;
};

/// Whether steps of this metric give every path its measured number of steps, to within 0.3 steps.
bool count_as_measured(const std::array<double, 9>& metric, std::span<const MeasuredWay> ways);

/// Returns those `fits` of this view that also match the counts of earlier views. All of them if none does: the
/// steps may have changed.
std::vector<StepFit> that_count_as_measured(std::vector<StepFit> fits, std::span<const MeasuredWay> ways);

/// Whether the metrics differ by a constant factor only.
bool of_one_shape(const std::array<double, 9>& one, const std::array<double, 9>& other);

/// Whether `way` distinguishes `metrics` by a quarter of a step or more. They gave equal counts when `steps`
/// were measured with the first of them; `steps` may have become longer or shorter since.
bool tells_apart(std::span<const std::array<double, 9>> metrics, const volume::RaySteps& steps,
                 const volume::Vec3& way);

}  // namespace understudy::spu
