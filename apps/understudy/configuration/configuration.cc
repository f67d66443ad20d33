// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/configuration/configuration.h"

#include <fmt/format.h>
#include <strings.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <string_view>
#include <system_error>

#define TOML_HEADER_ONLY 1
#include <toml++/toml.h>

namespace understudy::launcher {
namespace {

namespace fs = std::filesystem;

/// Returns the names of a viewer: its program and, if there is one, its Python script.
std::vector<std::string> names_of(const std::vector<std::string>& viewer) {
  std::vector<std::string> names;
  if (viewer.empty()) return names;
  names.push_back(fs::path(viewer.front()).filename());
  const auto script =
      std::ranges::find_if(viewer, [](const std::string& word) { return word.ends_with(".py"); });
  if (script != viewer.end()) names.push_back(fs::path(*script).stem());
  return names;
}

[[noreturn]] void fail(const fs::path& file, const toml::source_region& where, const std::string& what) {
  throw std::runtime_error(fmt::format("{}, line {}: {}", file.string(), where.begin.line, what));
}

ConfiguredOption option_of(const fs::path& file, const std::string& name, const toml::node& node,
                           const std::string& section) {
  ConfiguredOption option{name, {}, node.is_boolean(), section, int(node.source().begin.line)};
  if (const auto* text = node.as_string()) {
    option.value = text->get();
  } else if (const auto* whole = node.as_integer()) {
    option.value = std::to_string(whole->get());
  } else if (const auto* number = node.as_floating_point()) {
    option.value = fmt::format("{}", number->get());
  } else if (const auto* truth = node.as_boolean()) {
    option.value = truth->get() ? "on" : "off";
  } else {
    fail(file, node.source(), fmt::format("{} must be a string, a number, true or false", name));
  }
  return option;
}

void add_options(const fs::path& file, const toml::table& table, const std::string& section,
                 std::vector<ConfiguredOption>& options, std::vector<std::string>& known) {
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (section.empty() && node.is_table()) continue;
    if (std::ranges::find(known, name) != known.end()) continue;
    known.push_back(name);
    options.push_back(option_of(file, name, node, section));
  }
}

}  // namespace

fs::path configuration_file() {
  const auto folder = [](const char* variable) {
    const char* value = std::getenv(variable);
    return value != nullptr ? fs::path(value) : fs::path();
  };
  if (const char* file = std::getenv("UNDERSTUDY_CONFIG")) return file;
  if (const fs::path home = folder("XDG_CONFIG_HOME"); !home.empty()) return home / "understudy.toml";
  if (const fs::path home = folder("HOME"); !home.empty()) return home / ".config" / "understudy.toml";
  return {};
}

std::vector<ConfiguredOption> configured_options(const fs::path& file, const std::vector<std::string>& viewer) {
  std::error_code ignored;
  if (file.empty() || !fs::exists(file, ignored)) return {};
  toml::table table;
  try {
    table = toml::parse_file(file.string());
  } catch (const toml::parse_error& error) {
    fail(file, error.source(), std::string(error.description()));
  }
  std::vector<ConfiguredOption> options;
  std::vector<std::string> known;
  const std::vector<std::string> names = names_of(viewer);
  for (const auto& [key, node] : table) {
    const std::string section(key.str());
    const auto is_named = [&](const std::string& name) {
      return strcasecmp(name.c_str(), section.c_str()) == 0;
    };
    if (!node.is_table() || std::ranges::none_of(names, is_named)) continue;
    add_options(file, *node.as_table(), section, options, known);
  }
  add_options(file, table, "", options, known);
  return options;
}

}  // namespace understudy::launcher
