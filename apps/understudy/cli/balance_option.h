// SPDX-License-Identifier: Apache-2.0
// `--balance` of `run`, `replay`, `render`, `study`, `view` and `serve`: load balancing, that is, how much
// of a volume each node gets.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace understudy::launcher {

void add_balance_option(CLI::App& subcommand, std::string& balance);

}  // namespace understudy::launcher
