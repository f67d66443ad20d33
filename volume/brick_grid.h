// SPDX-License-Identifier: Apache-2.0
// Equal bricks of cells in a row along every axis, and the order in which they cover each other.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "volume/cell_lattice.h"
#include "volume/description.h"

namespace understudy::volume {

struct RenderRequest;

/// Bricks begin at `origin` and follow each other without gaps; the last of an axis may reach beyond the
/// volume.
struct BrickGrid {
  std::array<int, 3> origin{};  ///< the cell at which the first brick begins
  std::array<int, 3> counts{};  ///< of bricks
  int edge = 1;                 ///< of a brick, in cells

  /// The fewest bricks that begin at `first` and hold all cells up to `end`.
  static BrickGrid covering(const std::array<int, 3>& first, const std::array<int, 3>& end, int edge);

  std::size_t bricks() const;
  /// Bricks are numbered x fastest.
  std::array<int, 3> place(std::size_t brick) const;
  TexelBox cells(std::size_t brick) const;

  /// All bricks, such that on every ray samples in a brick named earlier come before those in one named later;
  /// exact for any camera while a request's planes keep one order over the image, as KdTree says. Throws
  /// std::invalid_argument when the matrix is singular.
  std::vector<std::size_t> in_visibility_order(const VolumeDescription& volume,
                                               const RenderRequest& request) const;
};

}  // namespace understudy::volume
