// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/units.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "spu/plugin/plugin_file.h"
#include "spu/registry/assemble.h"

namespace understudy::launcher {
namespace {

std::string about(const spu::UnitDescription& unit) {
  std::string text = fmt::format("{:8} {}", unit.name, unit.help);
  if (unit.needs != nullptr) text += fmt::format("; needs {} before it", unit.needs);
  if (unit.position == spu::UnitPosition::repeatable) text += "; may be used several times in a chain";
  return text + "\n";
}

std::string about(const spu::UnitOption& option) {
  const std::string fallback = *option.fallback == '\0' ? "" : fmt::format(" [{}]", option.fallback);
  return fmt::format("           {}={}{}\n             {}\n", option.name, spu::type_text(option), fallback,
                     option.help);
}

std::string about_all(const spu::UnitDescription& unit) {
  std::string text = about(unit);
  for (const spu::UnitOption& option : unit.options) text += about(option);
  return text;
}

/// Describes units from plugins, each with its file.
std::string plugins_text() {
  std::string text;
  for (const std::filesystem::path& file : spu::plugin_files()) {
    try {
      text += about_all(spu::load_plugin(file));
      text += fmt::format("           in {}\n", file.string());
    } catch (const std::runtime_error& error) {
      text += fmt::format("{:8} cannot be used: {}\n", file.stem().string(), error.what());
    }
  }
  return text;
}

std::string units_text() {
  std::string text;
  for (const spu::UnitDescription* unit : spu::unit_table()) text += about_all(*unit);
  return text + plugins_text() +
         "\nA chain lists units from the application to the driver, with their options in parentheses:\n"
         "  understudy run --chain 'perf(file=calls.json) track volume driver' -- viewer args…\n"
         "  understudy run --chain @chain.json -- viewer args…\n"
         R"(  chain.json: {"chain": [{"unit": "perf", "file": "calls.json"}, "track", "volume", "driver"]})"
         "\n";
}

}  // namespace

void add_units(CLI::App& app, std::function<int()>& chosen) {
  app.add_subcommand("units", "lists the stream processing units that --chain takes")->callback([&chosen] {
    chosen = [] {
      std::fputs(units_text().c_str(), stdout);
      return 0;
    };
  });
}

}  // namespace understudy::launcher
