// SPDX-License-Identifier: Apache-2.0
// Merges the slices of all bricks into one set: their polygons must be the intersection of one set of planes
// with one box, drawn in the order in which the bricks lie.
#pragma once

#include <span>

#include "spu/volume/geometry/recognised_run.h"
#include "spu/volume/merging/merged_volume.h"
#include "volume/request.h"

namespace understudy::spu {

/// The slices of one brick.
struct BrickSlices {
  GLuint texture = 0;
  const RecognisedRun* seen = nullptr;
};

/// The slices of the whole volume, in its texture space.
struct MergedSlices {
  CameraFit camera;
  SliceSet slices;
  std::vector<volume::HalfSpace> clip_planes;
};

/// Returns the request for a brick as one for the whole volume, for what does not depend on slices: where it
/// lies in the window.
volume::RenderRequest placed_as_whole(const MergedVolume& merged, GLuint texture,
                                      volume::RenderRequest request);

/// `bricks` in drawing order, all drawn by `pipeline`. Throws Refusal if they are not slices of one volume.
MergedSlices merged_slices(const MergedVolume& merged, std::span<const BrickSlices> bricks,
                           const Pipeline& pipeline);

}  // namespace understudy::spu
