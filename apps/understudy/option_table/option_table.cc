// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/option_table/option_table.h"

#include <algorithm>
#include <cctype>
#include <sstream>

namespace understudy::launcher {

namespace {

/// Returns the words of a list such as "on|off"; none for any other value, such as "BYTES|auto".
std::vector<std::string> words_of(const std::string& value) {
  std::vector<std::string> words;
  std::istringstream list(value);
  for (std::string word; std::getline(list, word, '|');) {
    const bool plain = std::ranges::all_of(word, [](unsigned char c) {
      return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '-' || c == ':';
    });
    if (!plain || word.empty()) return {};
    words.push_back(word);
  }
  return words.size() > 1 ? words : std::vector<std::string>{};
}

OptionRow row_of(const CLI::Option& option) {
  OptionRow row;
  for (const std::string& name : option.get_snames()) row.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) row.names.push_back("--" + name);
  if (option.get_items_expected_max() > 0) row.value = option.get_type_name();
  row.values = words_of(row.value);
  row.heading = option.get_group();
  row.description = option.get_description();
  if (option.get_positional()) row.place = option.get_single_name();
  return row;
}

}  // namespace

std::vector<OptionRow> option_rows(const CLI::App& subcommand) {
  std::vector<OptionRow> rows;
  for (const CLI::Option* const option :
       subcommand.get_options([](const CLI::Option* one) { return !one->get_group().empty(); }))
    rows.push_back(row_of(*option));
  return rows;
}

std::vector<SubcommandRow> option_table(const CLI::App& app) {
  std::vector<SubcommandRow> rows;
  for (const CLI::App* const subcommand : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (subcommand->get_group().empty()) continue;
    rows.push_back({subcommand->get_name(), subcommand->get_description(), option_rows(*subcommand)});
  }
  return rows;
}

}  // namespace understudy::launcher
