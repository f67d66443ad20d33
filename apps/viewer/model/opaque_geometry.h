// SPDX-License-Identifier: Apache-2.0
// Solid geometry beside the volume, drawn with depth test: the box's frame, three axis arrows, and a ball.
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

/// Frame: 12 grey lines just outside the box. Axes: arrows from the box's lowest corner;
/// x is red, y green, z blue.
OpaqueGeometry frame_and_axes(const Box& box);

/// Adds a ball that is partly within the box.
void add_ball(const Box& box, OpaqueGeometry& geometry);

/// Two triangles that cover the whole image, to be drawn with identity matrices.
OpaqueGeometry whole_image(const Vec3f& colour);

}  // namespace viewer
