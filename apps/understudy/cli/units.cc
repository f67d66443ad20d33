// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/units.h"

#include <fmt/format.h>

#include <cstdio>

namespace understudy::launcher {
namespace {

std::string about(const spu::UnitDescription& unit) {
  std::string text = fmt::format("{:8} {}", unit.name, unit.help);
  if (unit.needs != nullptr) text += fmt::format("; needs {} before it", unit.needs);
  if (unit.position == spu::UnitPosition::repeatable) text += "; may stand several times";
  return text + "\n";
}

std::string about(const spu::UnitOption& option) {
  const std::string fallback = *option.fallback == '\0' ? "" : fmt::format(" [{}]", option.fallback);
  return fmt::format("           {}={}{}\n             {}\n", option.name, spu::type_text(option), fallback,
                     option.help);
}

}  // namespace

std::string units_text(spu::UnitTable units) {
  std::string text;
  for (const spu::UnitDescription* unit : units) {
    text += about(*unit);
    for (const spu::UnitOption& option : unit->options) text += about(option);
  }
  return text +
         "\nA chain names them from the application to the driver, options in parentheses:\n"
         "  understudy run --chain 'perf(file=calls.json) track volume driver' -- viewer args…\n"
         "  understudy run --chain @chain.json -- viewer args…\n"
         R"(  chain.json: {"chain": [{"unit": "perf", "file": "calls.json"}, "track", "volume", "driver"]})"
         "\n";
}

void add_units(CLI::App& app, std::function<int()>& chosen) {
  app.add_subcommand("units", "lists the stream processing units that --chain takes")->callback([&chosen] {
    chosen = [] {
      std::fputs(units_text(spu::unit_table()).c_str(), stdout);
      return 0;
    };
  });
}

}  // namespace understudy::launcher
