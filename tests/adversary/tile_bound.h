// SPDX-License-Identifier: Apache-2.0
// Whether a shown image is right, tile by tile.
//
// Two bare runs say what the image may be: the viewer's own, which blends in 8 bits and filters with the
// driver's 8-bit weights, and an exact one, in which blending and filtering are done in floats. A pixel's
// excess is how far its worst channel lies outside the range between both, in 1/255. Rounding of the viewer's
// is thereby measured where it happens, instead of being allowed for everywhere.
//
// One sample more or less at a silhouette, or at a border of a step table, changes single pixels: so a tile is
// wrong only where more than an eighth of its pixels exceed the bound. README.md has the calibration.
#pragma once

#include "tests/adversary/image.h"

namespace adversary {

constexpr int tile_edge = 16;
constexpr int tile_bound = 4;  ///< in 1/255

struct TileScore {
  int excess = 0;    ///< more than an eighth of the tile's pixels have at least this, in 1/255
  int x = 0, y = 0;  ///< of the tile's corner, in pixels
};

/// The tile of the greatest score. All three images must have one size; throws std::runtime_error otherwise.
TileScore worst_tile(const Image& shown, const Image& bare, const Image& exact);

}  // namespace adversary
