// SPDX-License-Identifier: Apache-2.0
// The subcommands of a program and their options, as declared to CLI11. Manual pages and completions are
// generated from this table. Hidden entries are omitted.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace understudy::launcher {

struct OptionRow {
  std::vector<std::string> names;   ///< with dashes, short names first; empty: a positional argument
  std::string value;                ///< placeholder of its value, such as FILE; empty: takes no value
  std::vector<std::string> values;  ///< the words that it accepts; empty: other values
  std::string heading;              ///< heading of its group
  std::string description;
  std::string place;  ///< name of a positional argument
};

struct SubcommandRow {
  std::string name;
  std::string description;
  std::vector<OptionRow> options;
};

/// Returns the options of one subcommand.
std::vector<OptionRow> option_rows(const CLI::App& subcommand);
/// Returns the table of a command line. Options must already be grouped.
std::vector<SubcommandRow> option_table(const CLI::App& app);

}  // namespace understudy::launcher
