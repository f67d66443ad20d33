// SPDX-License-Identifier: Apache-2.0
// Points, maps, boxes and half-spaces of texture space, in double precision.
//
// Texture space is OpenGL's: the volume fills [0,1]^3, the centre of texel i of N is at (i + 1/2) / N, and the
// outer half texels belong to the volume.
#pragma once

#include <array>

namespace understudy::volume {

/// A point or a direction.
using Vec3 = std::array<double, 3>;
using Matrix4 = std::array<double, 16>;  ///< row-major: m[4 * row + column], acting on column vectors

/// Closed box; the default is the whole volume.
struct Box {
  Vec3 low{0, 0, 0};
  Vec3 high{1, 1, 1};
  bool operator==(const Box&) const = default;
};

/// Contains the points with normal . t + offset >= 0.
struct HalfSpace {
  Vec3 normal{};
  double offset = 0;
  bool operator==(const HalfSpace&) const = default;
};

}  // namespace understudy::volume
