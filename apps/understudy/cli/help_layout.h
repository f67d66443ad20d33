// SPDX-License-Identifier: Apache-2.0
// How help is printed: options in a column of 30, what they do beside it, no line longer than 100 columns.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <string>
#include <vector>

namespace understudy::launcher {

/// For CLI::App::formatter(); subcommands that are added afterwards take it over.
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

/// Puts the options of all of `app`'s subcommands under the headings of one table; hidden ones stay hidden.
void group_options(CLI::App& app);

}  // namespace understudy::launcher
