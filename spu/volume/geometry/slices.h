// SPDX-License-Identifier: Apache-2.0
// Determines the application's sampling from captured polygons: equidistant parallel planes through a box in
// texture space.
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

/// The order of drawing in which a blending equals the nodes' operator.
enum class SliceOrder { back_to_front, front_to_back, any };

/// The slices, or the reason why there are none, phrased for the report ("slices are not equally spaced").
using SliceFinding = std::variant<SliceSet, Refusal>;

/// `clip_planes` are the application's own, in texture space. The polygons must be exactly the intersection of
/// the planes with the region and the clip planes (and with the view volume, if `polygons.clipped`): their
/// areas are compared.
SliceFinding find_slices(const ObservedPolygons& polygons, const CameraFit& camera,
                         std::span<const volume::HalfSpace> clip_planes,
                         SliceOrder order = SliceOrder::back_to_front);

}  // namespace understudy::spu
