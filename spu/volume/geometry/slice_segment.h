// SPDX-License-Identifier: Apache-2.0
// Finds slice segments: an input of the fragment stage, other than the one that addresses the volume, that may
// address it a second time, at a fixed offset.
#pragma once

#include <cstddef>
#include <vector>

#include "spu/volume/geometry/capture.h"
#include "spu/volume/geometry/slices.h"
#include "volume/sampling.h"

namespace understudy::spu {

struct ObservedSegment {
  std::size_t input = 0;  ///< in the order of ProgramStages::inputs
  volume::SliceSegment slice_segment;
};

/// Returns the inputs of `capture` that differ from the coordinate at all vertices by one vector, or by one
/// number of planes along the ray. Whether colours depend on them is not known yet.
std::vector<ObservedSegment> find_slice_segments(const Capture& capture,
                                                 std::span<const ObservedVertex> vertices,
                                                 const std::vector<StageInput>& inputs, const SliceSet& slices,
                                                 const CameraFit& camera);

}  // namespace understudy::spu
