// SPDX-License-Identifier: Apache-2.0
#include "volume/transfer_control_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>

namespace understudy::volume {

namespace {

/// Fine enough that the distance between two entries is less than one 8-bit value.
constexpr int table_entries = 4096;

using ControlPoint = TransferControlPoints::ControlPoint;

struct Named {
  std::string_view name;
  std::vector<ControlPoint> control_points;
};

const std::array<Named, 5>& named() {
  static const std::array<Named, 5> all{{
      {"grey", {{0, {0, 0, 0}, 0}, {1, {1, 1, 1}, 0.1}}},
      // The casing nearly transparent, the denser parts inside it in colour.
      {"engine",
       {{0, {0.5, 0.5, 0.55}, 0},
        {0.28, {0.5, 0.5, 0.55}, 0},
        {0.38, {0.65, 0.68, 0.72}, 0.02},
        {0.55, {0.6, 0.64, 0.7}, 0.03},
        {0.68, {0.9, 0.45, 0.15}, 0.3},
        {1, {1, 0.85, 0.6}, 0.7}}},
      // Air transparent, soft tissue as a thin skin, bone solid.
      {"ct",
       {{0, {0.8, 0.55, 0.45}, 0},
        {0.22, {0.8, 0.55, 0.45}, 0},
        {0.3, {0.85, 0.6, 0.5}, 0.02},
        {0.42, {0.85, 0.55, 0.45}, 0.015},
        {0.5, {0.95, 0.9, 0.8}, 0.25},
        {1, {1, 1, 0.95}, 0.8}}},
      {"vessels",
       {{0, {0.5, 0, 0}, 0},
        {0.12, {0.6, 0.05, 0.05}, 0},
        {0.35, {0.9, 0.2, 0.1}, 0.3},
        {1, {1, 0.9, 0.7}, 0.9}}},
      {"rainbow",
       {{0, {0, 0, 1}, 0},
        {0.25, {0, 0.8, 1}, 0.01},
        {0.5, {0.1, 0.9, 0.2}, 0.03},
        {0.75, {1, 0.9, 0}, 0.08},
        {1, {1, 0.1, 0}, 0.2}}},
  }};
  return all;
}

bool in_unit_range(double value) {
  return value >= 0 && value <= 1;  // false for NaN
}

ControlPoint at(const std::vector<ControlPoint>& control_points, double place) {
  // The last control point at or before `place`: of two at one place, the second.
  const auto next = std::ranges::upper_bound(control_points, place, {}, &ControlPoint::at);
  if (next == control_points.begin()) return control_points.front();
  if (next == control_points.end()) return control_points.back();
  const ControlPoint &a = *(next - 1), &b = *next;
  const double share = (place - a.at) / (b.at - a.at);
  ControlPoint between{place, {}, a.opacity + share * (b.opacity - a.opacity)};
  for (std::size_t k = 0; k < 3; ++k) between.colour[k] = a.colour[k] + share * (b.colour[k] - a.colour[k]);
  return between;
}

}  // namespace

void check(const TransferControlPoints& control_points) {
  const auto fail = [](std::size_t point, const std::string& what) {
    throw std::invalid_argument(fmt::format("control point {}: {}", point + 1, what));
  };
  if (control_points.control_points.size() < 2)
    throw std::invalid_argument(
        fmt::format("{} control points are too few for a transfer function; give two at least, as in "
                    "[{{\"at\": 0, \"colour\": "
                    "[0, 0, 0], \"opacity\": 0}}, {{\"at\": 1, \"colour\": [1, 1, 1], \"opacity\": 0.1}}]",
                    control_points.control_points.size()));
  for (std::size_t i = 0; i < control_points.control_points.size(); ++i) {
    const ControlPoint& point = control_points.control_points[i];
    if (!std::isfinite(point.at)) fail(i, "its place is not a number; give the value that it stands at");
    if (!in_unit_range(point.opacity))
      fail(i, fmt::format("its opacity is {}, not 0 to 1; give that of one voxel's length", point.opacity));
    for (const double component : point.colour)
      if (!in_unit_range(component))
        fail(i, fmt::format("its colour has a component of {}, not 0 to 1", component));
    if (i > 0 && point.at < control_points.control_points[i - 1].at)
      fail(i, fmt::format("it stands at {}, before the one ahead of it at {}; sort them", point.at,
                          control_points.control_points[i - 1].at));
  }
  if (control_points.control_points.front().at == control_points.control_points.back().at)
    throw std::invalid_argument(fmt::format("all control points stand at {}; give them different places",
                                            control_points.control_points.front().at));
}

std::vector<std::string> built_in_control_points_names() {
  std::vector<std::string> names;
  for (const Named& row : named()) names.emplace_back(row.name);
  return names;
}

std::string built_in_control_points() {
  std::string names;
  for (const std::string& name : built_in_control_points_names()) names += (names.empty() ? "" : ", ") + name;
  return names;
}

TransferControlPoints control_points_named(const std::string& name) {
  const auto* const found = std::ranges::find(named(), name, &Named::name);
  if (found == named().end())
    throw std::invalid_argument(fmt::format("there is no transfer function '{}'; name a file, or one of {}",
                                            name, built_in_control_points()));
  return {false, found->control_points};
}

TransferControlPoints spanning(const TransferControlPoints& control_points, double low, double high) {
  check(control_points);
  TransferControlPoints spread = control_points;
  const double first = control_points.of_values ? low : 0, last = control_points.of_values ? high : 1;
  if (ControlPoint point = control_points.control_points.front(); first < point.at) {
    point.at = first;
    spread.control_points.insert(spread.control_points.begin(), point);
  }
  if (ControlPoint point = control_points.control_points.back(); last > point.at) {
    point.at = last;
    spread.control_points.push_back(point);
  }
  return spread;
}

void set_range(TransferFunction& function, double low, double high) {
  constexpr float greatest = std::numeric_limits<float>::max();
  const auto finite = [](double value) {
    return float(std::clamp(value, -double(greatest), double(greatest)));
  };
  function.low = std::min(finite(low), std::nextafter(greatest, 0.0F));
  function.high = std::max(finite(high), std::nextafter(function.low, greatest));
}

TransferFunction sampled(const TransferControlPoints& control_points, double low, double high, double step) {
  check(control_points);
  if (!(step > 0 && std::isfinite(step)))
    throw std::invalid_argument(fmt::format("a step of {} voxels leads nowhere; give a positive one", step));
  const double scale = control_points.of_values ? 1.0 : high - low,
               offset = control_points.of_values ? 0.0 : low;
  const double first = control_points.control_points.front().at, last = control_points.control_points.back().at;
  TransferFunction table;
  set_range(table, offset + scale * first, offset + scale * last);
  table.entries.reserve(table_entries);
  for (int i = 0; i < table_entries; ++i) {
    const ControlPoint point =
        at(control_points.control_points, first + (last - first) * i / (table_entries - 1));
    const double alpha = point.opacity >= 1 ? 1.0 : -std::expm1(step * std::log1p(-point.opacity));
    Rgba& entry = table.entries.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) entry[k] = float(point.colour[k] * alpha);
    entry[3] = float(alpha);
  }
  return table;
}

}  // namespace understudy::volume
