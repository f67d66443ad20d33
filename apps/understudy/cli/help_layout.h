// SPDX-License-Identifier: Apache-2.0
// Layout of the help: options in a column of 30, their descriptions beside it, no line longer than 100 columns.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <string>
#include <vector>

namespace understudy::launcher {

/// For CLI::App::formatter(); subcommands that are added afterwards inherit it.
class HelpLayout : public CLI::Formatter {
 public:
  static constexpr std::size_t columns = 100;

  std::string make_group(std::string heading, bool is_positional,
                         std::vector<const CLI::Option*> options) const override;
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_subcommand(const CLI::App* subcommand) const override;
  std::string make_description(const CLI::App* app) const override;
  std::string make_footer(const CLI::App* app) const override;
};

/// Groups the options of all subcommands of `app` under the headings of one table; hidden options stay hidden.
void group_options(CLI::App& app);

}  // namespace understudy::launcher
