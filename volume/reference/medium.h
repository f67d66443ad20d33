// SPDX-License-Identifier: Apache-2.0
// The optical properties of a field value: the right-hand side of the volume rendering integral
//
//   dT/dt = -extinction T,   dC/dt = source T,   T(0) = 1, C(0) = 0
//
// over the length t of a ray, in double precision and without a step size.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "volume/classification.h"

namespace understudy::volume {

/// Per unit of length.
struct Rate {
  std::array<double, 3> source{};
  double extinction = 0;
};

/// Rates as functions of the field's value: smooth between neighbouring control points, constant outside.
class Medium {
 public:
  /// Source and extinction are linear between `entries`, which are evenly spaced from `low` to `high`. Throws
  /// std::invalid_argument when there is none, or one is negative or not finite.
  static Medium of_rates(double low, double high, const std::vector<Rate>& entries);

  /// A transfer function as viewers define it: premultiplied colour and opacity of a sample are linear between
  /// entries, and a homogeneous layer as thick as the distance between samples shows exactly these. Its
  /// extinction, -log(1 - opacity) / distance, is not linear, and infinite at opacity 1. Throws
  /// std::invalid_argument when an entry is negative or not finite, an opacity is above 1, or the distance is
  /// not > 0.
  static Medium of_samples(const TransferFunction& function, double distance);

  /// Values at which the rates have a kink, ascending.
  const std::vector<double>& control_points() const { return control_points_; }

  /// Segment 0 lies below the first control point, segment i between control points i - 1 and i, the last above
  /// all control points.
  std::size_t segments() const { return control_points_.size() + 1; }
  std::size_t segment_of(double value) const;
  bool empty(std::size_t segment) const { return empty_[segment] != 0; }
  /// Whether opacity is 1 in the whole segment: no light passes, over any distance.
  bool opaque(std::size_t segment) const { return opaque_[segment] != 0; }
  /// Whether this holds for a path on which the field has the constant value `value`.
  bool opaque_at(std::size_t segment, double value) const;

  /// `value` must lie in `segment`.
  Rate rate(std::size_t segment, double value) const;

  /// Rounding error of the extinction in a segment, for values exact to the last bit: relatively large where
  /// the opacity begins to rise from 0.
  double noise(std::size_t segment) const;

  /// Premultiplied colour and opacity of one sample (of_samples); source and extinction (of_rates).
  std::array<double, 4> entry_at(std::size_t segment, double value) const;

 private:
  Medium(double low, double high, std::vector<std::array<double, 4>> entries, double distance);

  std::vector<double> control_points_;
  std::vector<std::array<double, 4>> entries_;  ///< at the control points
  double distance_;                             ///< 0: entries are rates
  std::vector<char> empty_;
  std::vector<char> opaque_;
};

/// Absorption and emission of a medium of which a layer of thickness `distance` has this premultiplied colour
/// and opacity. Opacity 1 is replaced by the next smaller number: infinite extinction at a value that the field
/// only crosses is integrable.
Rate rate_of_sample(const std::array<double, 4>& colour, double distance);

}  // namespace understudy::volume
