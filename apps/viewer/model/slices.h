// SPDX-License-Identifier: Apache-2.0
// View-aligned slices: planes perpendicular to the line of sight, intersected with the volume's box (Cabral,
// Cam and Foran 1994; the polygons are found edge by edge as in Rezk-Salama and Kolb 2005).
//
// The planes are equally spaced and symmetric about the box's centre. They span the bounding sphere of the
// box, so their spacing, and with it the opacity correction, is the same from every direction; planes that
// miss the box are omitted.
#pragma once

#include <cstdint>
#include <vector>

#include "apps/viewer/model/vector_math.h"
#include "apps/viewer/model/volume.h"

namespace viewer {

inline constexpr int max_slices = 1 << 16;

/// The volume in object space: a box with a diagonal of length 1, centred at the origin.
struct Box {
  Vec3 edges;
  double finest_voxel_edge;  ///< the reference distance of opacities
};
Box box_of(const VolumeSize& size, const Vec3& spacing);

struct SliceVertex {
  Vec3f texture;   ///< [0,1] over the box, border half voxels included
  Vec3f position;  ///< object space
};

struct Slice {
  double offset;        ///< distance of the plane from the origin along the stack's normal
  std::uint32_t first;  ///< into SliceStack::vertices
  std::uint32_t count;  ///< 3 to 6, a convex polygon in order
};

struct SliceStack {
  Vec3 normal{};       ///< direction of view, object space
  double spacing = 0;  ///< between neighbouring planes, object space
  bool front_to_back = false;
  std::vector<Slice> slices;  ///< farthest first, unless front to back
  std::vector<SliceVertex> vertices;
};

/// Returns the number of slices that span the bounding sphere: `requested`, or one per
/// finest voxel edge if it is 0.
int slices_across_diagonal(const Box& box, int requested);

/// Cuts the box by `across_diagonal` planes that span its bounding sphere; `direction` is the
/// direction of view, of length 1.
SliceStack cut_slices(const Box& box, const Vec3& direction, int across_diagonal);

}  // namespace viewer
