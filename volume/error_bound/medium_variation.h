// SPDX-License-Identifier: Apache-2.0
// How extinction and colour may change with the value, around a value: what a bound of the error needs to know
// of a transfer function.
//
// The medium is that of a function for steps of one length, whose opacity and premultiplied colour are linear
// between its entries; images are made with another function, for samples `step` of these lengths apart
// (opacity_correction.h). Per step of the image the medium has, where the first function's entry is (c, a),
//
//     the optical depth K = -step log(1 - a)    and the plain colour X = c / a
//
// On a piece between two entries K, K' and K'' go one way, and so do X, X' and X'': all take their greatest
// sizes at the piece's ends. Where nothing is visible X may be anything; it is taken to go on evenly from one
// visible piece to the next.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "volume/classification.h"

namespace understudy::volume {

/// Bounds over a range of values. Values are counted in entries of the function that images are made with.
struct MediumBounds {
  double depth = 0;         ///< the greatest K
  double depth_range = 0;   ///< between the greatest and the least K
  double depth_slope = 0;   ///< the greatest |K'|
  double depth_curve = 0;   ///< the greatest |K''| between kinks
  double depth_kinks = 0;   ///< the sum of jumps of K'
  double colour_range = 0;  ///< likewise of X, in the channel that has most of it
  double colour_slope = 0;
  double colour_curve = 0;
  double colour_kinks = 0;
  double glow = 0;          ///< the greatest colour that a step adds where there is no opacity
  double depth_error = 0;   ///< by which the images' function may differ from K between its entries
  double colour_error = 0;  ///< and from what a step of the medium shows
};

class MediumVariation {
 public:
  /// `of_images` must be `function` corrected to `step` by opacity_corrected().
  MediumVariation(const TransferFunction& function, double step, const TransferFunction& of_images);

  /// Over values up to `radius` away from those between the entries `entry` and `entry` + 1; at least.
  const MediumBounds& around(std::size_t entry, double radius) const;

  /// The brightest plain colour, of any channel.
  double brightest() const { return brightest_; }

 private:
  struct Piece;
  class Ranges;

  std::size_t entries_ = 0;
  double brightest_ = 0;
  std::vector<double> radii_;                         ///< rising
  std::vector<std::vector<MediumBounds>> by_radius_;  ///< of each radius, by entry
};

}  // namespace understudy::volume
