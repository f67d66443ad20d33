// SPDX-License-Identifier: Apache-2.0
// A bound for every tile of an image, instead of an average over the image: a wrong tile must fail in an image
// that is dark elsewhere, and a right image must pass although its transfer function has steps.
//
// A right image may differ by one sample at a silhouette or at a step of the transfer function, which moves a
// colour to a neighbouring pixel; and by little everywhere, because drivers use 8-bit weights. A pixel
// therefore counts by how far it lies outside of the colours that the other image has within one pixel of it
// (`excess`), and a tile by the mean of its pixels. A tile that shows something else has no such neighbours.
//
// Where colours change from pixel to pixel, as in a maximum projection through a table with steps, the
// neighbours have all colours. There a tile counts by the difference that an eighth of its pixels reach
// (`common`), pixel by pixel: a line of pixels at a silhouette has fewer.
#pragma once

#include <algorithm>
#include <array>

#include "spu/volume/verification/native_image.h"
#include "volume/image.h"

namespace understudy::spu {

constexpr int compared_tile_edge = 16;
/// The largest mean excess of a tile in a right image, as a fraction of the brightest colour. Calibrated in
/// docs/verification.md.
constexpr double max_tile_excess = 3.0 / 255;
/// The largest difference that an eighth of the pixels of a tile in a right image reach.
constexpr double max_common_difference = 8.0 / 255;

struct TileDifference {
  volume::Rect tile;           ///< in pixels of the window
  double excess = 0;           ///< mean over the tile's pixels
  double common = 0;           ///< the difference that an eighth of its pixels reach
  std::array<int, 2> pixel{};  ///< with the largest excess in the tile

  /// The bound is 1.
  double severity() const { return std::max(excess / max_tile_excess, common / max_common_difference); }
  bool within_bound(double bound = 1) const { return severity() <= bound; }
};

struct ImageDifference {
  double max = 0;
  double mean_square = 0;  ///< over all pixels, all four channels
  TileDifference worst;
  bool anything_visible = false;  ///< either image shows something

  double psnr() const;  ///< dB; infinite if equal
};

/// Compares a native image with the one that would replace it, which is empty outside of its rectangle; both as
/// the application's framebuffer could show them: clamped to [0,1] or, if it is float, as fractions of the
/// largest value.
ImageDifference difference_between(const Pipeline& pipeline, const NativeImage& native,
                                   const volume::ImageView& image);

}  // namespace understudy::spu
