// SPDX-License-Identifier: Apache-2.0
// A regular grid of equal bricks of cells, and its visibility order.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "volume/cell_lattice.h"
#include "volume/description.h"

namespace understudy::volume {

struct RenderRequest;

/// The bricks begin at `origin` and are contiguous; the last one along an axis may extend beyond the volume.
struct BrickGrid {
  std::array<int, 3> origin{};  ///< first cell of the first brick
  std::array<int, 3> counts{};  ///< numbers of bricks
  int edge = 1;                 ///< of a brick, in cells

  /// The fewest bricks that begin at `first` and contain all cells up to `end`.
  static BrickGrid covering(const std::array<int, 3>& first, const std::array<int, 3>& end, int edge);

  std::size_t bricks() const;
  /// Coordinates of a brick; bricks are numbered x fastest.
  std::array<int, 3> place(std::size_t brick) const;
  TexelBox cells(std::size_t brick) const;

  /// All bricks, ordered so that on every ray the samples of a brick precede those of bricks later in the list.
  /// Exact for any camera as long as the request's planes have the same order over the whole image (see
  /// KdTree). Throws std::invalid_argument when the matrix is singular.
  std::vector<std::size_t> in_visibility_order(const VolumeDescription& volume,
                                               const RenderRequest& request) const;
};

}  // namespace understudy::volume
