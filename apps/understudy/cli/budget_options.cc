// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/budget_options.h"

#include <fmt/format.h>

#include "spu/options.h"

namespace understudy::launcher {
namespace {

constexpr const char* error_variable = "UNDERSTUDY_ERROR";
constexpr const char* time_variable = "UNDERSTUDY_TIME";

CLI::Validator can_set(const char* variable) {
  return {[variable](const std::string& text) -> std::string {
            spu::Options options;
            return spu::set_option(options, variable, text)
                       ? ""
                       : fmt::format("'{}' is not a value this option takes", text);
          },
          ""};
}

}  // namespace

void add_budget_options(CLI::App& subcommand, BudgetArguments& arguments) {
  CLI::Option* const step = subcommand.get_option("--step");
  subcommand
      .add_option("--error", arguments.error,
                  "take the fewest samples that keep every channel of every pixel within E of the integral, "
                  "instead of those of --step, --method and --termination: a number like 0.002 or a fraction "
                  "like 0.5/255, above 0 and at most 1")
      ->type_name("E")
      ->check(can_set(error_variable))
      ->excludes(step);
  subcommand
      .add_option("--time", arguments.time,
                  "take as many samples as can be cast in T per image, instead of those of --step, --method "
                  "and --termination: 30ms or 0.03s, above 0 and at most a minute; --error takes precedence")
      ->type_name("T")
      ->check(can_set(time_variable))
      ->excludes(step);
}

spu::BudgetAsked budget_asked(const BudgetArguments& arguments, bool may_halve) {
  spu::Options options;
  spu::set_option(options, error_variable, arguments.error);
  spu::set_option(options, time_variable, arguments.time);
  return {options.error, options.time_ms, may_halve};
}

}  // namespace understudy::launcher
