// SPDX-License-Identifier: Apache-2.0
// The subcommand `run`: its options, and those of the option table that other subcommands take too.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/understudy/launch/run_viewer.h"

namespace understudy::launcher {

/// The arguments of this program, and those of the viewer behind the first "--".
struct CommandLine {
  std::vector<std::string> own;  ///< former options in today's words
  std::vector<std::string> viewer;
};

CommandLine split_at_double_dash(int argc, char** argv);

/// One command-line option for every row of the option table that has a flag, but for the flags in `without`.
void add_options_of_the_table(CLI::App& subcommand, const std::shared_ptr<RunArguments>& arguments,
                              std::span<const std::string_view> without = {});

/// Of this run, only warnings and errors are said.
void say_less(RunArguments& arguments);

/// Adds the subcommand; when it is parsed, `chosen` runs it.
void add_run(CLI::App& app, const std::vector<std::string>& viewer, std::function<int()>& chosen);

}  // namespace understudy::launcher
