// SPDX-License-Identifier: Apache-2.0
// What is drawn before the volume, solid and with depth test: the box's frame and three axis arrows.
#pragma once

#include <vector>

#include "apps/viewer/model/slices.h"

namespace viewer {

struct ColouredVertex {
  Vec3f position;
  Vec3f colour;
};

struct OpaqueGeometry {
  std::vector<ColouredVertex> lines;      ///< two vertices each
  std::vector<ColouredVertex> triangles;  ///< three vertices each
};

/// Frame: 12 grey lines just outside the box. Axes: arrows from the box's lowest corner, x red, y green, z
/// blue.
OpaqueGeometry frame_and_axes(const Box& box);

/// A ball that is partly within the box.
void add_ball(const Box& box, OpaqueGeometry& geometry);

/// Two triangles over the whole image, to be drawn with matrices of one.
OpaqueGeometry whole_image(const Vec3f& colour);

}  // namespace viewer
