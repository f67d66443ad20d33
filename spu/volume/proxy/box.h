// SPDX-License-Identifier: Apache-2.0
// Proxy geometry: the box whose faces a ray caster draws, and the rays through it.
#pragma once

#include <optional>
#include <vector>

#include "spu/volume/geometry/polygon.h"
#include "volume/texture_space.h"

namespace understudy::spu {

/// Returns the box (in units of the observed coordinate) whose faces the polygons cover exactly once: all six,
/// or only those that `camera` sees from outside. Null if the polygons are anything else.
std::optional<volume::Box> box_of(const ObservedPolygons& polygons, const volume::Matrix4& camera);

/// True if the whole box lies in front of the eye and beyond the near plane: then every ray enters at a face.
bool wholly_in_view(const volume::Matrix4& texture_to_clip, const volume::Box& box);

/// Likewise for the vertices that were drawn.
bool wholly_in_view(const ObservedPolygons& polygons);

/// The part of a ray inside a box, in texture space.
struct WayThroughBox {
  volume::Vec3 entry{};
  volume::Vec3 way{};  ///< from entry to exit
};

/// The rays of a camera through a box, which cuts may have reduced.
class RaysThroughBox {
 public:
  /// `texture_to_clip` must be invertible.
  RaysThroughBox(const volume::Matrix4& texture_to_clip, const volume::Box& box,
                 const std::vector<volume::HalfSpace>& cuts = {});

  /// Returns the path of the ray at normalised device coordinates (x, y); null if the ray misses the box.
  std::optional<WayThroughBox> through(double x, double y) const;
  /// Likewise, only the vector from entry to exit.
  std::optional<volume::Vec3> way(double x, double y) const;

  /// Where the middle of the box is seen; for a box with cuts, where the path through it is longest.
  std::array<double, 2> middle() const { return middle_; }

 private:
  volume::Matrix4 clip_to_texture_;
  volume::Box box_;
  std::vector<volume::HalfSpace> cuts_;
  std::array<double, 2> middle_{};
};

}  // namespace understudy::spu
