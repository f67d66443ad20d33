// SPDX-License-Identifier: Apache-2.0
// The user's configuration file as words of the command line of `understudy run`, and `understudy config`,
// which shows what holds.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "apps/understudy/cli/run.h"

namespace understudy::launcher {

/// `line` with what the configuration file says of options that neither `line` nor the environment gives. Other
/// subcommands than `run` stay as they are. Throws std::runtime_error with the file and the line of an option
/// that `run`, a subcommand of `app`, does not have.
CommandLine with_configuration(const CLI::App& app, CommandLine line);

/// Adds the subcommand `config`; when it is parsed, `chosen` runs it.
void add_config(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
