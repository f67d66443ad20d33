// SPDX-License-Identifier: Apache-2.0
// The subcommands of a program and their options, as its command line declares them: what manual pages and
// completions are made of. Hidden ones are left out.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace understudy::launcher {

struct OptionRow {
  std::vector<std::string> names;   ///< with their dashes, short ones first; empty: a positional argument
  std::string value;                ///< what stands for its value, as FILE; empty: it takes none
  std::vector<std::string> values;  ///< the words that it takes; empty: others
  std::string heading;              ///< of its group
  std::string description;
  std::string place;  ///< of a positional argument: its name
};

struct SubcommandRow {
  std::string name;
  std::string description;
  std::vector<OptionRow> options;
};

/// Of one subcommand.
std::vector<OptionRow> option_rows(const CLI::App& subcommand);
/// Of a command line whose options stand in their groups already.
std::vector<SubcommandRow> option_table(const CLI::App& app);

}  // namespace understudy::launcher
