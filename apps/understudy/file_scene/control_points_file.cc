// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/file_scene/control_points_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace understudy::launcher {
namespace {

constexpr std::uintmax_t max_file_bytes = std::uintmax_t(1) << 20;

double number(const nlohmann::json& from, const char* name) {
  const auto found = from.find(name);
  if (found == from.end() || !found->is_number())
    throw std::runtime_error(fmt::format("'{}' is missing or not a number", name));
  return found->get<double>();
}

volume::TransferControlPoints::ControlPoint control_point_in(const nlohmann::json& from) {
  volume::TransferControlPoints::ControlPoint point;
  point.at = number(from, "at");
  point.opacity = number(from, "opacity");
  const auto colour = from.find("colour");
  if (colour == from.end() || !colour->is_array() || colour->size() != 3)
    throw std::runtime_error("'colour' is missing or not a list of three numbers");
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(*colour)[k].is_number())
      throw std::runtime_error("'colour' is missing or not a list of three numbers");
    point.colour[k] = (*colour)[k].get<double>();
  }
  return point;
}

}  // namespace

volume::TransferControlPoints control_points_in(const nlohmann::json& json) {
  volume::TransferControlPoints control_points;
  const std::string positions = json.value("positions", "range");
  if (positions != "range" && positions != "values")
    throw std::runtime_error(fmt::format("'positions' is '{}'; it must be range or values", positions));
  control_points.of_values = positions == "values";
  const auto list = json.find("knots");
  if (list == json.end() || !list->is_array()) throw std::runtime_error("the list 'knots' is missing");
  for (const nlohmann::json& entry : *list) {
    try {
      control_points.control_points.push_back(control_point_in(entry));
    } catch (const std::exception& error) {
      throw std::runtime_error(
          fmt::format("control point {}: {}", control_points.control_points.size() + 1, error.what()));
    }
  }
  check(control_points);
  return control_points;
}

volume::TransferControlPoints read_control_points(const std::string& file_or_name) {
  if (!std::filesystem::exists(file_or_name)) return volume::control_points_named(file_or_name);
  try {
    if (!std::filesystem::is_regular_file(file_or_name)) throw std::runtime_error("not a regular file");
    if (std::filesystem::file_size(file_or_name) > max_file_bytes)
      throw std::runtime_error(
          fmt::format("has more than {} bytes; give fewer control points", max_file_bytes));
    std::ifstream file(file_or_name);
    return control_points_in(nlohmann::json::parse(file));
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(
        fmt::format("{}: not a transfer function: {}; expected {{\"knots\": [{{\"at\": 0, \"colour\": [0, 0, "
                    "0], \"opacity\": 0}}, …]}}",
                    file_or_name, error.what()));
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("{}: not a transfer function: {}", file_or_name, error.what()));
  }
}

}  // namespace understudy::launcher
