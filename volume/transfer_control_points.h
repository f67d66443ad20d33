// SPDX-License-Identifier: Apache-2.0
// Transfer functions as people write them: colour and opacity at a few values, linear in between.
#pragma once

#include <string>
#include <vector>

#include "volume/classification.h"

namespace understudy::volume {

/// Constant beyond the first and the last control point. docs/render.md says how files look.
struct TransferControlPoints {
  struct ControlPoint {
    double at = 0;
    std::array<double, 3> colour{};  ///< plain, not multiplied by opacity, 0 to 1
    double opacity = 0;              ///< of one unit of length, 0 to 1
  };

  bool of_values = false;  ///< `at` is a value; otherwise 0 is the volume's least value and 1 its greatest
  std::vector<ControlPoint> control_points;  ///< rising; two at one place make a step
};

/// Throws std::invalid_argument naming the control point: fewer than two, not rising, not finite, out of range.
void check(const TransferControlPoints& control_points);

/// A built-in one. Throws std::invalid_argument, with the names that there are.
TransferControlPoints control_points_named(const std::string& name);
/// Names that control_points_named() knows.
std::vector<std::string> built_in_control_points_names();
/// "grey, engine, ..."
std::string built_in_control_points();

/// The same function with control points at the ends of the volume's values, `low` and `high`, where there were
/// none beyond: pre-integration wants to know where on its way a segment leaves the table.
TransferControlPoints spanning(const TransferControlPoints& control_points, double low, double high);

/// The table for samples `step` units of length apart, over the values from `low` to `high` of the volume; its
/// range is in values. Opacity becomes 1 - (1 - opacity)^step. Throws as check() does, and for a step that is
/// no positive number.
TransferFunction sampled(const TransferControlPoints& control_points, double low, double high, double step);

}  // namespace understudy::volume
