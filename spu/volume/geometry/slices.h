// SPDX-License-Identifier: Apache-2.0
// From observed polygons to the application's sampling: equidistant parallel planes through a box of texture
// space.
#pragma once

#include <string>
#include <variant>

#include "spu/volume/geometry/fit.h"
#include "spu/volume/geometry/polygon.h"
#include "spu/volume/refusal/refusal.h"
#include "volume/sampling.h"

namespace understudy::spu {

struct SliceSet {
  volume::SlicePlanes planes;  ///< plane 0 is nearest to the eye
  volume::Box region;          ///< the box of texture space that the slices fill
};

/// The order of drawing under which a blending means what the nodes do.
enum class SliceOrder { back_to_front, front_to_back, any };

/// Either the slices, or why they are none, in words that end in the report ("slices are not equally spaced").
using SliceFinding = std::variant<SliceSet, Refusal>;

/// `clip_planes` are the application's own, in texture space. The polygons must be exactly what the planes cut
/// out of the region and the clip planes (and of the view volume, where `polygons.clipped`): their area is the
/// check.
SliceFinding find_slices(const ObservedPolygons& polygons, const CameraFit& camera,
                         std::span<const volume::HalfSpace> clip_planes,
                         SliceOrder order = SliceOrder::back_to_front);

}  // namespace understudy::spu
