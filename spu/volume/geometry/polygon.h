// SPDX-License-Identifier: Apache-2.0
// Output of the application's pipeline for a run of slices: polygons whose vertices have both the texture
// coordinate that addresses the volume and the clip position.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "volume/texture_space.h"

namespace understudy::spu {

struct ObservedVertex {
  volume::Vec3 texture{};  ///< coordinate after texgen, texture matrix and division by q
  std::array<double, 4> clip{};
};

/// Convex polygons in drawing order: polygon p has vertices [first[p], first[p + 1]).
struct ObservedPolygons {
  std::vector<ObservedVertex> vertices;
  std::vector<std::size_t> first{0};
  /// True if the polygons were clipped: what lies outside the view volume is missing.
  bool clipped = false;
  /// The colour that reaches texturing (glColor, or lighting with a constant normal); null if it varies.
  std::optional<std::array<float, 4>> constant_colour{{1, 1, 1, 1}};

  std::size_t count() const { return first.size() - 1; }
  std::span<const ObservedVertex> polygon(std::size_t p) const {
    return std::span(vertices).subspan(first[p], first[p + 1] - first[p]);
  }
};

}  // namespace understudy::spu
