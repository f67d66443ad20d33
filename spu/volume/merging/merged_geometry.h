// SPDX-License-Identifier: Apache-2.0
// From the runs of all bricks to one: their polygons must be what one set of planes cuts out of one box, drawn
// in the order in which the bricks lie.
#pragma once

#include <span>

#include "spu/volume/geometry/recognised_run.h"
#include "spu/volume/merging/merged_volume.h"

namespace understudy::spu {

/// The slices of one brick.
struct BrickSlices {
  GLuint texture = 0;
  const RecognisedRun* seen = nullptr;
};

/// The slices of the whole, as its texture space has them.
struct MergedSlices {
  CameraFit camera;
  SliceSet slices;
  std::vector<volume::HalfSpace> clip_planes;
};

/// `bricks` in the order of drawing, by one `pipeline`. Throws Refusal where they are not slices of one volume.
MergedSlices merged_slices(const MergedVolume& merged, std::span<const BrickSlices> bricks,
                           const Pipeline& pipeline);

}  // namespace understudy::spu
