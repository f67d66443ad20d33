// SPDX-License-Identifier: Apache-2.0
// A box whose corner before the near plane was cut off, and closed again, by the application itself: what some
// ray casters draw when the eye is inside their volume.
#pragma once

#include <optional>

#include "spu/volume/geometry/polygon.h"
#include "volume/texture_space.h"

namespace understudy::spu {

struct CutBox {
  volume::Box box;        ///< around what is left
  volume::HalfSpace cut;  ///< in units of the observed coordinate
};

/// The box and its cut, where the polygons are the closed surface of a box that one plane has cut.
std::optional<CutBox> cut_box_of(const ObservedPolygons& polygons);

}  // namespace understudy::spu
