// SPDX-License-Identifier: Apache-2.0
#include "spu/chain_json.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "spu/former_names.h"

namespace understudy::spu {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* form = R"({"chain": ["track", {"unit": "perf", "file": "calls.json"}, "driver"]})";

/// The value as it would be written in the text form.
std::string option_value(const Json& value, const std::string& where) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "on" : "off";
  if (value.is_number()) return value.dump();
  throw ChainError(
      where, fmt::format("an option's value is text, a number, true or false, not {}", value.type_name()));
}

UnitSetting unit_setting(const Json& entry, const std::string& where) {
  if (entry.is_string()) return {present_unit(entry.get<std::string>()), {}, where};
  if (!entry.is_object() || !entry.contains("unit") || !entry["unit"].is_string()) {
    throw ChainError(where, R"(a unit is "name", or {"unit": "name", "option": value})");
  }
  UnitSetting unit{present_unit(entry["unit"].get<std::string>()), {}, where};
  for (const auto& [name, value] : entry.items()) {
    if (name == "unit") continue;
    const std::string place = where + "." + shown(name);
    unit.options.push_back({present_unit_option(name), option_value(value, place), place});
  }
  return unit;
}

}  // namespace

ChainSettings parse_chain_json(std::string_view text, const std::string& name) {
  if (text.size() > max_chain_bytes) {
    throw ChainError(name, fmt::format("it is {} bytes long; {} are the limit", text.size(), max_chain_bytes));
  }
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw ChainError(fmt::format("{}, byte {}", name, error.byte),
                     fmt::format("this is not JSON; a chain looks like {}", form));
  }
  if (!json.is_object() || !json.contains("chain") || !json["chain"].is_array()) {
    throw ChainError(name, fmt::format("there is no list named \"chain\"; a chain looks like {}", form));
  }
  for (const auto& [key, value] : json.items()) {
    if (key != "chain") {
      throw ChainError(name, fmt::format("\"{}\" means nothing here; there is \"chain\" alone", shown(key)));
    }
  }
  const Json& list = json["chain"];
  if (list.size() > max_chain_units) {
    throw ChainError(name, fmt::format("a chain has at most {} units", max_chain_units));
  }
  ChainSettings chain;
  for (std::size_t i = 0; i < list.size(); ++i) {
    chain.push_back(unit_setting(list[i], fmt::format("{}, chain[{}]", name, i)));
  }
  return chain;
}

ChainSettings read_chain_file(const std::string& path) {
  std::error_code unreadable;
  if (std::filesystem::is_directory(path, unreadable)) throw ChainError(path, "is a folder, not a chain file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw ChainError(path, fmt::format("cannot read this chain file: {}", std::strerror(errno)));
  // One byte above the limit shows that a file is too long.
  std::string text(max_chain_bytes + 1, '\0');
  file.read(text.data(), std::streamsize(text.size()));
  text.resize(std::size_t(file.gcount()));
  return parse_chain_json(text, path);
}

}  // namespace understudy::spu
