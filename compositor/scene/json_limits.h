// SPDX-License-Identifier: Apache-2.0
// Bounds of a text in JSON, checked before a value is made of it: what walks a value calls itself for each
// level, looks keys up one by one, and takes memory many times that of the text.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "compositor/scene/exported_scene.h"
#include "compositor/service/limits.h"

namespace understudy::compositor {

constexpr std::size_t max_json_depth = 16;
constexpr std::size_t max_json_keys = 64;                             ///< of one object
constexpr std::uint64_t max_json_values = limits::max_window_pixels;  ///< of one list: a depth image
constexpr std::size_t max_json_parts = limits::max_table_entries;     ///< lists and objects in one list

/// Gets the text's events from nlohmann-json. Throws SceneError if a bound is exceeded. Text that is not valid
/// is left to the parser, whose message is better.
class JsonLimits : public nlohmann::json_sax<nlohmann::ordered_json> {
 public:
  bool null() override { return count_value(); }
  bool boolean(bool) override { return count_value(); }
  bool number_integer(number_integer_t) override { return count_value(); }
  bool number_unsigned(number_unsigned_t) override { return count_value(); }
  bool number_float(number_float_t, const string_t&) override { return count_value(); }
  bool string(string_t&) override { return count_value(); }
  bool binary(binary_t&) override { return count_value(); }
  bool start_object(std::size_t) override { return enter(); }
  bool start_array(std::size_t) override { return enter(); }
  bool end_object() override { return leave(); }
  bool end_array() override { return leave(); }
  bool key(string_t&) override {
    if (++open_.back().keys > max_json_keys)
      throw SceneError(fmt::format("an object has more than {} keys", max_json_keys));
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception&) override { return false; }

 private:
  struct Level {
    std::size_t keys = 0;
    std::uint64_t values = 0;
    std::size_t parts = 0;
  };

  bool count_value() {
    if (!open_.empty() && ++open_.back().values > max_json_values)
      throw SceneError(fmt::format("a list has more than {} values", max_json_values));
    return true;
  }
  bool enter() {
    count_value();
    if (!open_.empty() && ++open_.back().parts > max_json_parts)
      throw SceneError(fmt::format("a list has more than {} lists or objects", max_json_parts));
    if (open_.size() == max_json_depth)
      throw SceneError(fmt::format("it is nested deeper than {} levels", max_json_depth));
    open_.emplace_back();
    return true;
  }
  bool leave() {
    open_.pop_back();
    return true;
  }

  std::vector<Level> open_;  ///< lists and objects, the outermost first
};

}  // namespace understudy::compositor
