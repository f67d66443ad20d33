// SPDX-License-Identifier: Apache-2.0
// The subcommand `run`: its options, and those of the option table that other subcommands share.
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

/// The arguments of this program, and those of the viewer after the first "--".
struct CommandLine {
  std::vector<std::string> own;  ///< with former option names replaced by present ones
  std::vector<std::string> viewer;
};

CommandLine split_at_double_dash(int argc, char** argv);

/// Adds a command-line option for every row of the option table that has a flag, except
/// for the flags in `without`.
void add_options_of_the_table(CLI::App& subcommand, const std::shared_ptr<RunArguments>& arguments,
                              std::span<const std::string_view> without = {});

/// Limits the messages of this run to warnings and errors.
void say_less(RunArguments& arguments);

/// Adds the subcommand; when it is parsed, sets `chosen` to run it.
void add_run(CLI::App& app, const std::vector<std::string>& viewer, std::function<int()>& chosen);

}  // namespace understudy::launcher
