// SPDX-License-Identifier: Apache-2.0
// The estimated cost of an image, by tile, as a summed-area table: the cost of any rectangle takes four
// lookups. (Crow 1984; for sort-first balance Moloney, Weiskopf, Moeller, Strengert 2007.)
#pragma once

#include <span>
#include <vector>

#include "volume/rect.h"

namespace understudy::compositor {

/// Returns the tiles of volume/occlusion.h that intersect `pixels`, row by row from the bottom, clipped to it.
std::vector<volume::Rect> tiles_of(const volume::Rect& pixels);

class CostImage {
 public:
  /// `costs` are those of tiles_of(pixels), in that order; within a tile all pixels cost the same. NaN,
  /// infinite and negative costs count as zero.
  CostImage(const volume::Rect& pixels, std::span<const float> costs);

  const volume::Rect& pixels() const { return pixels_; }
  /// Returns the cost of the pixels of `rect` that lie in pixels().
  double within(const volume::Rect& rect) const;

 private:
  /// Returns the cost of all pixels to the left of x and below y.
  double below(int x, int y) const;

  volume::Rect pixels_;
  std::vector<int> columns_, rows_;  ///< where tiles begin, and where the last one ends
  std::vector<double> sums_;         ///< below() at every corner of a tile
};

}  // namespace understudy::compositor
