// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/preset_file.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/viewer/model/error.h"

namespace viewer {

namespace {

ControlPoint control_point_in(const nlohmann::json& point) {
  const nlohmann::json& colour = point.at("colour");
  return {point.at("at"), colour.at(0), colour.at(1), colour.at(2), point.at("opacity")};
}

bool in_unit_range(double value) {
  return value >= 0 && value <= 1;  // false for NaN
}

}  // namespace

PresetFile::PresetFile(const std::string& path) : path_(path) {
  const auto fail = [&](const std::string& what) {
    throw Error(ExitCode::bad_file,
                fmt::format("{}: {}; expected {{\"knots\": [{{\"at\": 0, \"colour\": [0, 0, 0], \"opacity\": "
                            "0}}, …]}}, with values between 0 and 1, sorted by \"at\"",
                            path, what));
  };
  std::ifstream file(path);
  if (!file) fail("cannot be read");
  try {
    const nlohmann::json all = nlohmann::json::parse(file);
    for (const nlohmann::json& point : all.at("knots")) points_.push_back(control_point_in(point));
  } catch (const nlohmann::json::exception& error) {
    fail(fmt::format("not a transfer function: {}", error.what()));
  }
  if (points_.size() < 2) fail(fmt::format("{} control points are too few", points_.size()));
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const ControlPoint& p = points_[i];
    for (const double number : {p.value, p.red, p.green, p.blue, p.opacity})
      if (!in_unit_range(number)) fail(fmt::format("control point {} has the value {}", i + 1, number));
    if (i > 0 && p.value < points_[i - 1].value)
      fail(fmt::format("control point {} lies before the preceding one", i + 1));
  }
  preset_ = {path_, "from a file", points_};
}

}  // namespace viewer
