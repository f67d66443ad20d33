// SPDX-License-Identifier: Apache-2.0
// `--error` and `--time` of `render`, with the same values as those of `run`.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "spu/volume/budget/budget.h"

namespace understudy::launcher {

struct BudgetArguments {
  std::string error = "none";
  std::string time = "none";
};

/// Call it after `--step` has been added, which both options exclude.
void add_budget_options(CLI::App& subcommand, BudgetArguments& arguments);

spu::BudgetAsked budget_asked(const BudgetArguments& arguments, bool may_halve);

}  // namespace understudy::launcher
