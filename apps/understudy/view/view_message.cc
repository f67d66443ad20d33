// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/view/view_message.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/understudy/file_scene/control_points_file.h"
#include "volume/file/series.h"
#include "volume/surface.h"

namespace understudy::launcher {
namespace {

using Json = nlohmann::json;

constexpr double farthest_point = 1000;
constexpr double longest_wait_ms = 1e6;

[[noreturn]] void fail(const char* key, const std::string& what) {
  throw MalformedView(fmt::format("'{}' {}", key, what));
}

double number_in(const char* key, const Json& json, double least, double most) {
  if (!json.is_number()) fail(key, "is not a number");
  const auto value = json.get<double>();
  if (!(value >= least && value <= most)) fail(key, fmt::format("is not between {:g} and {:g}", least, most));
  return value;
}

bool flag_in(const char* key, const Json& json) {
  if (!json.is_boolean()) fail(key, "is neither true nor false");
  return json.get<bool>();
}

template <std::size_t count>
std::array<double, count> numbers_in(const char* key, const Json& json, double least, double most) {
  if (!json.is_array() || json.size() != count) fail(key, fmt::format("is not a list of {} numbers", count));
  std::array<double, count> values{};
  for (std::size_t i = 0; i < count; ++i) values[i] = number_in(key, json[i], least, most);
  return values;
}

ImagePoint point_in(const char* key, const Json& json) {
  return numbers_in<2>(key, json, -farthest_point, farthest_point);
}

const Json& member(const char* key, const Json& json, const char* name) {
  const auto found = json.find(name);
  if (!json.is_object() || found == json.end()) fail(key, fmt::format("has no '{}'", name));
  return *found;
}

ViewCamera camera_in(const Json& json) {
  constexpr const char* key = "camera";
  ViewCamera camera;
  camera.orbit.azimuth = number_in(key, member(key, json, "azimuth"), -1e6, 1e6);
  camera.orbit.elevation = number_in(key, member(key, json, "elevation"), -90, 90);
  camera.orbit.distance = number_in(key, member(key, json, "distance"), nearest_distance, farthest_distance);
  camera.orbit.roll = number_in(key, member(key, json, "roll"), -1e6, 1e6);
  camera.shift = numbers_in<2>(key, member(key, json, "shift"), -farthest_shift, farthest_shift);
  return camera;
}

volume::TransferControlPoints table_in(const Json& json) {
  constexpr const char* key = "table";
  if (member(key, json, "knots").size() > max_view_control_points)
    fail(key, fmt::format("has more than {} control points", max_view_control_points));
  try {
    volume::TransferControlPoints table = control_points_in(json);
    if (table.of_values) fail(key, "has positions that are values, instead of positions in the range");
    return table;
  } catch (const MalformedView&) {
    throw;
  } catch (const std::exception& error) {
    fail(key, fmt::format("is not a transfer function: {}", error.what()));
  }
}

std::vector<SurfaceChoice> surfaces_in(const Json& json) {
  constexpr const char* key = "surfaces";
  if (!json.is_array() || json.size() > volume::max_surfaces)
    fail(key, fmt::format("is not a list of at most {} surfaces", volume::max_surfaces));
  std::vector<SurfaceChoice> surfaces;
  for (const Json& entry : json) {
    SurfaceChoice& surface = surfaces.emplace_back();
    surface.of_range = true;
    surface.at = number_in(key, member(key, entry, "at"), 1e-6, 1);
    const auto colour = numbers_in<3>(key, member(key, entry, "colour"), 0, 1);
    for (std::size_t k = 0; k < 3; ++k) surface.colour[k] = float(colour[k]);
    surface.colour[3] = float(number_in(key, member(key, entry, "opacity"), 0.001, 1));
  }
  return surfaces;
}

}  // namespace

ViewMessage decode_view_message(std::string_view text) {
  if (text.size() > max_view_message_bytes)
    throw MalformedView(
        fmt::format("a message of {} bytes exceeds the limit of {}", text.size(), max_view_message_bytes));
  // Invalid JSON yields a discarded value, which is not an object.
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) throw MalformedView("the message is not a JSON object");
  ViewMessage message;
  for (const auto& [key, value] : json.items()) {
    if (key == "sequence")
      message.sequence = std::uint64_t(number_in("sequence", value, 0, 9007199254740991.0));
    else if (key == "still")
      message.still = flag_in("still", value);
    else if (key == "lossless")
      message.lossless = flag_in("lossless", value);
    else if (key == "took_ms")
      message.took_ms = number_in("took_ms", value, 0, longest_wait_ms);
    else if (key == "size") {
      const auto size = numbers_in<2>("size", value, least_view_side, most_view_side);
      message.size = {int(size[0]), int(size[1])};
    } else if (key == "camera")
      message.camera = camera_in(value);
    else if (key == "rotate") {
      if (!value.is_array() || value.size() != 2) fail("rotate", "is not a list of two points");
      message.rotate = {point_in("rotate", value[0]), point_in("rotate", value[1])};
    } else if (key == "pan")
      message.pan = point_in("pan", value);
    else if (key == "zoom")
      message.zoom = {number_in("zoom", member("zoom", value, "by"), 1e-3, 1e3),
                      point_in("zoom", member("zoom", value, "at"))};
    else if (key == "table")
      message.table = table_in(value);
    else if (key == "volume")
      message.shows_volume = flag_in("volume", value);
    else if (key == "surfaces")
      message.surfaces = surfaces_in(value);
    else if (key == "light")
      message.light = flag_in("light", value);
    else if (key == "step")
      message.step = number_in("step", value, least_view_step, most_view_step);
    else if (key == "time_step")
      message.time_step = int(number_in("time_step", value, 0, double(volume::max_time_steps)));
    else
      throw MalformedView("the message has an unknown key");
  }
  return message;
}

}  // namespace understudy::launcher
