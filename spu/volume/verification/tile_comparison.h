// SPDX-License-Identifier: Apache-2.0
// A bound for every tile of an image, not an average over all of it: a wrong tile must fail in an image that is
// dark elsewhere, and a right image under a step table must pass.
//
// What may differ in a right image: by one sample at a silhouette or at a step of the transfer function, which
// moves a colour to a neighbouring pixel; and by little everywhere, as drivers weight texels by 8 bits. So a
// pixel counts by how far it lies outside of the colours that the other image has within one pixel of it
// (`excess`), and a tile by the mean of its pixels. A tile that shows something else has no such neighbours.
//
// Where colours change from pixel to pixel, as a maximum through a table with steps does, neighbours have all
// of them. There a tile counts by the difference that an eighth of its pixels reach (`common`), pixel against
// pixel: a line of pixels at a silhouette is less.
#pragma once

#include <algorithm>
#include <array>

#include "spu/volume/verification/native_image.h"
#include "volume/image.h"

namespace understudy::spu {

constexpr int compared_tile_edge = 16;
/// The largest mean excess of a tile in a right image, as a part of the brightest colour. Calibrated in
/// docs/verification.md.
constexpr double max_tile_excess = 3.0 / 255;
/// The largest difference that an eighth of the pixels of a tile in a right image reach.
constexpr double max_common_difference = 8.0 / 255;

struct TileDifference {
  volume::Rect tile;           ///< in pixels of the window
  double excess = 0;           ///< mean over the tile's pixels
  double common = 0;           ///< the difference that an eighth of its pixels reach
  std::array<int, 2> pixel{};  ///< of the largest excess in the tile

  /// 1 is the bound.
  double severity() const { return std::max(excess / max_tile_excess, common / max_common_difference); }
  bool within_bound(double bound = 1) const { return severity() <= bound; }
};

struct ImageDifference {
  double max = 0;
  double mean_square = 0;  ///< over all pixels, all four channels
  TileDifference worst;
  bool anything_visible = false;  ///< either image shows something

  double psnr() const;  ///< dB; infinite when equal
};

/// Between a native image and the one that would replace it, which shows nothing outside of its rectangle; both
/// as the application's framebuffer could show them: clamped to [0,1], or, where it is float, as parts of the
/// largest value.
ImageDifference difference_between(const Pipeline& pipeline, const NativeImage& native,
                                   const volume::ImageView& image);

}  // namespace understudy::spu
