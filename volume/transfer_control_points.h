// SPDX-License-Identifier: Apache-2.0
// Transfer functions as users write them: colour and opacity at a few values, linear in between.
#pragma once

#include <string>
#include <vector>

#include "volume/classification.h"

namespace understudy::volume {

/// Constant beyond the first and the last control point. docs/render.md documents the file format.
struct TransferControlPoints {
  struct ControlPoint {
    double at = 0;
    std::array<double, 3> colour{};  ///< plain (not premultiplied), 0 to 1
    double opacity = 0;              ///< of one unit of length, 0 to 1
  };

  bool of_values = false;  ///< true: `at` is a value; false: 0 is the volume's least value and 1 its greatest
  std::vector<ControlPoint> control_points;  ///< ascending; two at one place make a step
};

/// Throws std::invalid_argument naming the control point: too few, not ascending, not finite, out of range.
void check(const TransferControlPoints& control_points);

/// Returns the built-in transfer function of this name. Throws std::invalid_argument that lists the names.
TransferControlPoints control_points_named(const std::string& name);
/// The names that control_points_named() accepts.
std::vector<std::string> built_in_control_points_names();
/// "grey, engine, ..."
std::string built_in_control_points();

/// Returns the same function with additional control points at `low` and `high`, the ends of the volume's
/// values, if they lie beyond its own: pre-integration needs to find where a segment leaves the table.
TransferControlPoints spanning(const TransferControlPoints& control_points, double low, double high);

/// Sets the ends of a transfer function, with low <= high, to finite floats that differ even where rounding
/// would make them equal.
void set_range(TransferFunction& function, double low, double high);

/// The transfer function for samples `step` units of length apart, for a volume with values from `low` to
/// `high`; its range is in values. Opacity becomes 1 - (1 - opacity)^step. Throws as check() does, and for a
/// step that is not a positive number.
TransferFunction sampled(const TransferControlPoints& control_points, double low, double high, double step);

}  // namespace understudy::volume
