// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/configured_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <optional>
#include <stdexcept>

#include "apps/understudy/configuration/configuration.h"
#include "apps/understudy/option_table/usage_error.h"
#include "spu/options.h"

namespace understudy::launcher {
namespace {

/// Returns the environment variable of the option; empty if it has none.
std::string variable_of(const std::string& name) {
  for (const spu::OptionText& option : spu::option_table()) {
    // For example "-n,--nodes".
    const std::string_view flag = option.flag;
    if (flag.substr(flag.rfind(',') + 1) == "--" + name) return option.environment;
  }
  return {};
}

std::optional<std::string> value_of_variable(const std::string& name) {
  const std::string variable = variable_of(name);
  const char* value = variable.empty() ? nullptr : std::getenv(variable.c_str());
  return value != nullptr ? std::optional<std::string>(value) : std::nullopt;
}

std::vector<std::string> names_of_options(const CLI::App& run) {
  std::vector<std::string> names;
  for (const CLI::Option* option : run.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back(name);
  }
  return names;
}

const CLI::Option& option_of(const CLI::App& run, const ConfiguredOption& configured) {
  if (const CLI::Option* option = run.get_option_no_throw("--" + configured.name)) return *option;
  const std::string meant = nearest_word(configured.name, names_of_options(run));
  throw std::runtime_error(fmt::format("{}, line {}: `understudy run` has no option --{}{}",
                                       configuration_file().string(), configured.line, configured.name,
                                       meant.empty() ? "" : fmt::format("; did you mean {}?", meant)));
}

/// Returns whether `words` give the option, as --name, --name=value, -n or -nvalue.
bool gives(const std::vector<std::string>& words, const CLI::Option& option) {
  return std::ranges::any_of(words, [&](const std::string& word) {
    const auto is_long = [&](const std::string& name) {
      return word == "--" + name || word.starts_with("--" + name + "=");
    };
    const auto is_short = [&](const std::string& name) {
      return word.starts_with("-" + name) && !word.starts_with("--");
    };
    return std::ranges::any_of(option.get_lnames(), is_long) ||
           std::ranges::any_of(option.get_snames(), is_short);
  });
}

bool is_switch(const CLI::Option& option) {
  return option.get_items_expected_max() == 0;
}

/// Returns the words that give the option; none for a switch that is off. Throws std::runtime_error.
std::vector<std::string> words_of(const ConfiguredOption& configured, const CLI::Option& option) {
  if (!is_switch(option)) return {fmt::format("--{}={}", configured.name, configured.value)};
  if (!configured.is_true_or_false)
    throw std::runtime_error(fmt::format("{}, line {}: {} is a switch; its value must be true or false",
                                         configuration_file().string(), configured.line, configured.name));
  if (configured.value == "off") return {};
  return {"--" + configured.name};
}

void print_option(const CLI::Option& option, const std::vector<ConfiguredOption>& configured) {
  const std::string name = option.get_lnames().front();
  if (name == "help") return;
  std::string value;
  std::string from;
  const auto found = std::ranges::find(configured, name, &ConfiguredOption::name);
  if (const auto variable = value_of_variable(name)) {
    value = *variable;
    from = variable_of(name);
  } else if (found != configured.end()) {
    value = found->value;
    from = found->section.empty() ? fmt::format("line {}", found->line)
                                  : fmt::format("line {}, [{}]", found->line, found->section);
  } else {
    return;
  }
  fmt::print("  --{:24} {:30} {}\n", name, value, from);
}

int show_configuration(const CLI::App& run, const std::vector<std::string>& viewer) {
  const std::filesystem::path file = configuration_file();
  const std::vector<ConfiguredOption> configured = configured_options(file, viewer);
  for (const ConfiguredOption& option : configured) option_of(run, option);
  fmt::print("{}{}\n", file.string(), std::filesystem::exists(file) ? "" : " (does not exist)");
  fmt::print("{}\n", viewer.empty() ? "for all viewers:" : fmt::format("for {}:", viewer.front()));
  for (const CLI::Option* option : run.get_options()) {
    if (!option->get_lnames().empty()) print_option(*option, configured);
  }
  fmt::print("All other options have their defaults; for a list: understudy run --help\n");
  return 0;
}

}  // namespace

CommandLine with_configuration(const CLI::App& app, CommandLine line) {
  if (line.own.size() < 2 || line.own[1] != "run") return line;
  if (std::ranges::any_of(line.own, [](const std::string& word) { return word == "--help" || word == "-h"; }))
    return line;
  const CLI::App& run = *app.get_subcommand("run");
  std::vector<std::string> words;
  for (const ConfiguredOption& configured : configured_options(configuration_file(), line.viewer)) {
    const CLI::Option& option = option_of(run, configured);
    if (gives(line.own, option) || value_of_variable(configured.name)) continue;
    for (std::string& word : words_of(configured, option)) words.push_back(std::move(word));
  }
  line.own.insert(line.own.begin() + 2, words.begin(), words.end());
  return line;
}

void add_config(CLI::App& app, std::function<int()>& chosen) {
  const auto viewer = std::make_shared<std::vector<std::string>>();
  CLI::App* subcommand = app.add_subcommand(
      "config", "prints the options of `understudy run` that the configuration file and the environment set");
  subcommand
      ->add_option("viewer", *viewer, "viewer whose options are printed; without it, those of all viewers")
      ->type_name("PROGRAM");
  subcommand->callback([&app, viewer, &chosen] {
    chosen = [&app, viewer] { return show_configuration(*app.get_subcommand("run"), *viewer); };
  });
}

}  // namespace understudy::launcher
