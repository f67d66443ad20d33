// SPDX-License-Identifier: Apache-2.0
// Turns the user's configuration file into words of the command line of `understudy run`; and `understudy
// config`, which prints the options in effect.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "apps/understudy/cli/run.h"

namespace understudy::launcher {

/// Returns `line` with the options of the configuration file that neither `line` nor the environment sets.
/// Leaves subcommands other than `run` unchanged. Throws std::runtime_error with the file and the line of an
/// option that `run`, a subcommand of `app`, does not have.
CommandLine with_configuration(const CLI::App& app, CommandLine line);

/// Adds the subcommand `config`; when it is parsed, sets `chosen` to run it.
void add_config(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
