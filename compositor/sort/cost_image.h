// SPDX-License-Identifier: Apache-2.0
// The estimated cost of an image, tile by tile, as a summed-area table: the cost of any rectangle is four
// lookups. (Crow 1984; for sort-first balance Moloney, Weiskopf, Moeller, Strengert 2007.)
#pragma once

#include <span>
#include <vector>

#include "volume/rect.h"

namespace understudy::compositor {

/// The tiles of volume/occlusion.h that `pixels` touch, row by row from the bottom, cut to `pixels`.
std::vector<volume::Rect> tiles_of(const volume::Rect& pixels);

class CostImage {
 public:
  /// `costs` are those of tiles_of(pixels), in that order; within a tile all pixels cost the same. What is no
  /// number, or negative, counts as nothing.
  CostImage(const volume::Rect& pixels, std::span<const float> costs);

  const volume::Rect& pixels() const { return pixels_; }
  /// Of the pixels of `rect` that lie in pixels().
  double within(const volume::Rect& rect) const;

 private:
  /// Of all pixels to the left of x and below y.
  double below(int x, int y) const;

  volume::Rect pixels_;
  std::vector<int> columns_, rows_;  ///< where tiles begin, and the last one ends
  std::vector<double> sums_;         ///< below() at every corner of a tile
};

}  // namespace understudy::compositor
