// SPDX-License-Identifier: Apache-2.0
// Writes and reads the fields of a list (request_fields.h) as JSON. Numbers keep their exact value; an absent
// optional value is null.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "compositor/scene/request_fields.h"
#include "volume/classification.h"

namespace understudy::compositor {

using Json = nlohmann::ordered_json;

[[noreturn]] void fail_at(const std::string& key, std::string_view what);

/// The key of a classification's alternative, and the words for it.
constexpr const char* classification_kind = "kind";
constexpr std::array<const char*, std::variant_size_v<volume::Classification>> classification_kinds{
    "transfer_function", "linear_map", "pre_integration_table"};

/// Returns the position of the word; fails if it is none of them.
std::size_t place_of(const Json& word, std::span<const char* const> known, const std::string& key);

class JsonWriter {
 public:
  JsonWriter(Json& object, std::string key) : object_(object), key_(std::move(key)) {
    object_ = Json::object();
  }

  template <class T>
  void operator()(const char* name, const T& value) {
    put(object_[name], value, key_ + "." + name);
  }
  /// Infinity is written as null.
  void unbounded(const char* name, float value) {
    if (std::isinf(value) && value > 0)
      object_[name] = nullptr;
    else
      (*this)(name, value);
  }

 private:
  static void put(Json& to, bool value, const std::string&) { to = value; }
  static void put(Json& to, int value, const std::string&) { to = value; }
  static void put(Json& to, std::uint8_t value, const std::string&) { to = int(value); }
  static void put(Json& to, double value, const std::string& key) {
    if (!std::isfinite(value)) fail_at(key, "is not finite");
    to = value;
  }
  static void put(Json& to, float value, const std::string& key) { put(to, double(value), key); }
  template <class Enum>
  requires std::is_enum_v<Enum>
  static void put(Json& to, Enum value, const std::string&) { to = words<Enum>.at(std::size_t(value)); }
  template <class T, std::size_t n>
  static void put(Json& to, const std::array<T, n>& values, const std::string& key) {
    put_list(to, values, key);
  }
  template <class T>
  static void put(Json& to, const std::vector<T>& values, const std::string& key) {
    put_list(to, values, key);
  }
  template <class T>
  static void put(Json& to, const std::optional<T>& value, const std::string& key) {
    if (value)
      put(to, *value, key);
    else
      to = nullptr;
  }
  static void put(Json& to, const volume::Classification& value, const std::string& key) {
    std::visit([&](const auto& each) { put(to, each, key); }, value);
    to[classification_kind] = classification_kinds[value.index()];
  }
  template <class T>
  static void put(Json& to, const T& value, const std::string& key) requires requires(JsonWriter writer) {
    fields(writer, value);
  }
  {
    JsonWriter writer(to, key);
    fields(writer, value);
  }
  template <class Values>
  static void put_list(Json& to, const Values& values, const std::string& key) {
    to = Json::array();
    for (const auto& value : values) put(to.emplace_back(), value, key);
  }

  Json& object_;
  std::string key_;
};

class JsonReader {
 public:
  /// Fails if `object` is none.
  JsonReader(const Json& object, std::string key) : object_(object), key_(std::move(key)) {
    if (!object_.is_object()) fail_at(key_, "is not an object");
  }

  template <class T>
  void operator()(const char* name, T& value) {
    take(member(name), value, key_ + "." + name);
  }
  void unbounded(const char* name, float& value) {
    if (member(name).is_null())
      value = std::numeric_limits<float>::infinity();
    else
      (*this)(name, value);
  }

 private:
  const Json& member(const char* name) const {
    const auto found = object_.find(name);
    if (found == object_.end()) fail_at(key_ + "." + name, "is missing");
    return *found;
  }

  static void take(const Json& from, bool& value, const std::string& key) {
    if (!from.is_boolean()) fail_at(key, "is neither true nor false");
    value = from.get<bool>();
  }
  static void take(const Json& from, int& value, const std::string& key) {
    value = int(integer(from, std::numeric_limits<int>::min(), std::numeric_limits<int>::max(), key));
  }
  static void take(const Json& from, std::uint8_t& value, const std::string& key) {
    value = std::uint8_t(integer(from, 0, std::numeric_limits<std::uint8_t>::max(), key));
  }
  static void take(const Json& from, double& value, const std::string& key) {
    if (!from.is_number()) fail_at(key, "is not a number");
    value = from.get<double>();
    if (!std::isfinite(value)) fail_at(key, "is not finite");
  }
  static void take(const Json& from, float& value, const std::string& key) {
    double number = 0;
    take(from, number, key);
    if (std::abs(number) > double(std::numeric_limits<float>::max())) fail_at(key, "is too large for a float");
    value = float(number);
  }
  template <class Enum>
  requires std::is_enum_v<Enum>
  static void take(const Json& from, Enum& value, const std::string& key) {
    value = Enum(place_of(from, words<Enum>, key));
  }
  template <class T, std::size_t n>
  static void take(const Json& from, std::array<T, n>& values, const std::string& key) {
    if (!from.is_array() || from.size() != n) fail_at(key, "is not a list of " + std::to_string(n) + " values");
    for (std::size_t i = 0; i < n; ++i) take(from[i], values[i], key);
  }
  template <class T>
  static void take(const Json& from, std::vector<T>& values, const std::string& key) {
    if (!from.is_array()) fail_at(key, "is not a list");
    // Elements may be larger than their text: the first wrong one ends it. JsonLimits bounds their number.
    values.clear();
    for (const Json& each : from) take(each, values.emplace_back(), key);
  }
  template <class T>
  static void take(const Json& from, std::optional<T>& value, const std::string& key) {
    value.reset();
    if (!from.is_null()) take(from, value.emplace(), key);
  }
  static void take(const Json& from, volume::Classification& value, const std::string& key) {
    const JsonReader reader(from, key);
    switch (
        place_of(reader.member(classification_kind), classification_kinds, key + "." + classification_kind)) {
      case 0:
        return take(from, value.emplace<0>(), key);
      case 1:
        return take(from, value.emplace<1>(), key);
      default:
        return take(from, value.emplace<2>(), key);
    }
  }
  template <class T>
  static void take(const Json& from, T& value, const std::string& key) requires requires(JsonReader reader) {
    fields(reader, value);
  }
  {
    JsonReader reader(from, key);
    fields(reader, value);
  }
  static std::int64_t integer(const Json& from, std::int64_t low, std::int64_t high, const std::string& key);

  const Json& object_;
  std::string key_;
};

}  // namespace understudy::compositor
