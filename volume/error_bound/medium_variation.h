// SPDX-License-Identifier: Apache-2.0
// How extinction and colour may change with the field's value, near a value: the properties of a transfer
// function that error bounds depend on.
//
// The medium is defined by a function for steps of one length, whose opacity and premultiplied colour are
// linear between its entries. Images use another function, for samples `step` of these lengths apart
// (opacity_correction.h). Per step of the image, where the first function's entry is (c, a), the medium has
//
//     the optical depth K = -step log(1 - a)    and the plain colour X = c / a
//
// On a piece between two entries K, K' and K'' are monotone, and so are X, X' and X'': all have their greatest
// magnitudes at the piece's ends. Where nothing is visible X is arbitrary; it is interpolated linearly between
// the neighbouring visible pieces.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "volume/classification.h"

namespace understudy::volume {

/// Bounds over a range of values, in units of entries of the function that images use.
struct MediumBounds {
  double depth = 0;         ///< the greatest K
  double depth_range = 0;   ///< between the greatest and the least K
  double depth_slope = 0;   ///< the greatest |K'|
  double depth_curve = 0;   ///< the greatest |K''| between kinks
  double depth_kinks = 0;   ///< the sum of jumps of K'
  double colour_range = 0;  ///< likewise for X, in the channel where it is greatest
  double colour_slope = 0;
  double colour_curve = 0;
  double colour_kinks = 0;
};

/// The medium at one value.
struct MediumPoint {
  double depth = 0;                ///< K, infinite where it is opaque
  std::array<double, 3> colour{};  ///< X
};

class MediumVariation {
 public:
  /// `of_images` must be `function` corrected to `step` by opacity_corrected(). Throws std::invalid_argument if
  /// an entry of `function` has a negative component, an opacity above 1, or a colour without opacity: what
  /// emits without absorbing has no plain colour.
  MediumVariation(const TransferFunction& function, double step, const TransferFunction& of_images);

  /// Bounds over at least all values up to `radius` away from those between entries `entry` and `entry` + 1.
  const MediumBounds& around(std::size_t entry, double radius) const;

  /// `place`: in entries of the function that images use, within them.
  MediumPoint at(double place) const;

  /// The greatest channel of any plain colour.
  double brightest() const { return brightest_; }

 private:
  struct Piece;
  class Ranges;
  /// Plain colours at the ends of a piece where nothing is visible.
  struct Unseen {
    std::array<double, 3> low{}, high{};
  };

  TransferFunction function_;
  double step_ = 1;
  double in_function_ = 1;  ///< entries of `function_` per entry of the images' function
  std::vector<Unseen> unseen_;
  std::size_t entries_ = 0;
  double brightest_ = 0;
  std::vector<double> radii_;                         ///< ascending
  std::vector<std::vector<MediumBounds>> by_radius_;  ///< for each radius, by entry
};

}  // namespace understudy::volume
