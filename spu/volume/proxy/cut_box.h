// SPDX-License-Identifier: Apache-2.0
// A box whose corner in front of the near plane the application has cut off and closed again: what some ray
// casters draw while the eye is inside their volume.
#pragma once

#include <optional>

#include "spu/volume/geometry/polygon.h"
#include "volume/texture_space.h"

namespace understudy::spu {

struct CutBox {
  volume::Box box;        ///< bounding box of what is left
  volume::HalfSpace cut;  ///< in units of the observed coordinate
};

/// Returns the box and its cut if the polygons are the closed surface of a box that one plane has cut;
/// otherwise null.
std::optional<CutBox> cut_box_of(const ObservedPolygons& polygons);

}  // namespace understudy::spu
