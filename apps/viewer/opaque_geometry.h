// What is drawn before the volume, solid and with depth test: the box's frame and three axis arrows.
#pragma once

#include <vector>

#include "apps/viewer/slices.h"

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

}  // namespace viewer
