// SPDX-License-Identifier: Apache-2.0
// Proxy geometry: the box whose faces a ray caster draws, and the rays through it.
#pragma once

#include <optional>
#include <vector>

#include "spu/volume/geometry/polygon.h"
#include "volume/texture_space.h"

namespace understudy::spu {

/// The box (in units of the observed coordinate) whose faces, whole and once each, are what was drawn: all six,
/// or, where `camera` looks at two or three of them, these. Null when the polygons are anything else.
std::optional<volume::Box> box_of(const ObservedPolygons& polygons, const volume::Matrix4& camera);

/// True when all of the box lies before the eye and behind the near plane: then every ray enters at a face.
bool wholly_in_view(const volume::Matrix4& texture_to_clip, const volume::Box& box);

/// The same of the vertices that were drawn.
bool wholly_in_view(const ObservedPolygons& polygons);

/// A ray's stretch in a box, in texture space.
struct WayThroughBox {
  volume::Vec3 entry{};
  volume::Vec3 way{};  ///< from entry to exit
};

/// The rays of a camera through a box, which cuts may have made smaller.
class RaysThroughBox {
 public:
  /// `texture_to_clip` must be regular.
  RaysThroughBox(const volume::Matrix4& texture_to_clip, const volume::Box& box,
                 const std::vector<volume::HalfSpace>& cuts = {});

  /// Of the ray at normalised device coordinates (x, y); null where it misses the box.
  std::optional<WayThroughBox> through(double x, double y) const;
  /// From entry to exit.
  std::optional<volume::Vec3> way(double x, double y) const;

  /// Where the middle of the box is seen; of a box with cuts, where most of it lies behind another.
  std::array<double, 2> middle() const { return middle_; }

 private:
  volume::Matrix4 clip_to_texture_;
  volume::Box box_;
  std::vector<volume::HalfSpace> cuts_;
  std::array<double, 2> middle_{};
};

}  // namespace understudy::spu
