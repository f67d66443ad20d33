// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/option_table/usage_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <vector>

#include "apps/understudy/option_table/option_table.h"

namespace understudy::launcher {

namespace {

using WordSpan = std::span<const std::string>;

/// Returns how many letters must be inserted, deleted, replaced or exchanged with the next (Damerau 1964; only
/// adjacent letters are exchanged).
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before, last(b.size() + 1), next(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    next[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t same = a[i - 1] == b[j - 1] ? 0 : 1;
      next[j] = std::min({last[j] + 1, next[j - 1] + 1, last[j - 1] + same});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        next[j] = std::min(next[j], before[j - 2] + 1);
    }
    before = last;
    std::swap(last, next);
  }
  return last[b.size()];
}

std::string with_nearest(std::string sentence, const std::string& word, WordSpan known) {
  if (const std::string nearest = nearest_word(word, known); !nearest.empty())
    sentence += fmt::format("; did you mean '{}'?", nearest);
  return sentence;
}

/// Returns the part of "--option=value" before the '='.
std::string option_name(const std::string& word) {
  return word.substr(0, word.find('='));
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* const option : app.get_options()) {
    if (option->get_group().empty()) continue;
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

std::vector<std::string> subcommand_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const SubcommandRow& row : option_table(app)) names.push_back(row.name);
  return names;
}

const CLI::App* subcommand_of(const CLI::App& app, const std::string& word) {
  const auto all = app.get_subcommands([&](const CLI::App* one) { return one->get_name() == word; });
  return all.empty() ? nullptr : all.front();
}

/// Returns the first unrecognised word, in the order of the line: an option that `subcommand` does not have, or
/// a word that belongs to no option.
std::optional<std::string> left_over(const CLI::App& subcommand, WordSpan words) {
  const std::vector<std::string> all = subcommand.remaining();
  const auto found = std::ranges::find_if(
      words, [&](const std::string& word) { return std::ranges::find(all, word) != all.end(); });
  return found == words.end() ? std::nullopt : std::optional(*found);
}

/// An invalid value of `option`, and the words that it accepts.
struct WrongValue {
  std::string option;
  std::string value;
  std::vector<std::string> known;
};

std::optional<WrongValue> wrong_value(const CLI::App& subcommand, const std::string& message, WordSpan words) {
  for (const OptionRow& row : option_rows(subcommand)) {
    if (row.values.empty()) continue;
    const std::vector<std::string> names = row.names.empty() ? std::vector{row.place} : row.names;
    // CLI11 begins its message with all names of the option, or with one of them.
    const bool concerned = std::ranges::any_of(names, [&](const std::string& name) {
      return message.starts_with(name + ":") || message.starts_with(name + ",");
    });
    if (!concerned) continue;
    for (std::size_t i = 0; i < words.size(); ++i) {
      std::optional<std::string> value;
      const std::size_t equals = words[i].find('=');
      const bool own = std::ranges::find(names, option_name(words[i])) != names.end();
      if (row.names.empty() && message.find(words[i]) != std::string::npos) value = words[i];
      if (own && equals != std::string::npos) value = words[i].substr(equals + 1);
      if (own && equals == std::string::npos && i + 1 < words.size()) value = words[i + 1];
      if (value && std::ranges::find(row.values, *value) == row.values.end())
        return WrongValue{names.back(), *value, row.values};
    }
  }
  return {};
}

std::string explanation(const CLI::App& app, WordSpan words, const CLI::ParseError& error) {
  if (words.empty())
    return fmt::format("the subcommand is missing; give one of {}", fmt::join(subcommand_names(app), ", "));
  const CLI::App* const subcommand = subcommand_of(app, words.front());
  if (subcommand == nullptr) {
    const std::vector<std::string> known =
        words.front().starts_with('-') ? option_names(app) : subcommand_names(app);
    return with_nearest(fmt::format("there is no {} '{}'",
                                    words.front().starts_with('-') ? "option" : "subcommand", words.front()),
                        words.front(), known);
  }
  const WordSpan own = words.subspan(1);
  const std::string& name = subcommand->get_name();
  const bool too_much = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  const bool too_little = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
  const auto extra = too_much || too_little ? left_over(*subcommand, own) : std::nullopt;
  if (extra && (too_much || extra->starts_with('-'))) {
    if (extra->starts_with('-'))
      return with_nearest(fmt::format("{} has no option {}", name, option_name(*extra)), option_name(*extra),
                          option_names(*subcommand));
    // The beginning of a viewer's command is not one of our options.
    if (name == "run") return "put -- before the viewer's command: understudy run [options] -- viewer args…";
    return fmt::format("{} does not take '{}'", name, *extra);
  }
  if (const auto wrong = wrong_value(*subcommand, error.what(), own))
    return with_nearest(
        fmt::format("{}: '{}' is not one of {}", wrong->option, wrong->value, fmt::join(wrong->known, ", ")),
        wrong->value, wrong->known);
  const std::string said = error.what();
  return fmt::format("{}{} {}", name, said.starts_with('-') ? "" : ":", said);
}

}  // namespace

std::string nearest_word(const std::string& word, WordSpan known) {
  std::string nearest;
  // Up to a third of the letters may be wrong.
  std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& candidate : known) {
    const bool begins = word.size() > 2 && candidate.starts_with(word);
    const std::size_t distance = begins ? 1 : edit_distance(word, candidate);
    if (distance >= least || distance >= candidate.size()) continue;
    least = distance;
    nearest = candidate;
  }
  return nearest;
}

std::string usage_error_text(const CLI::App& app, WordSpan words, const CLI::ParseError& error) {
  const CLI::App* const subcommand = words.empty() ? nullptr : subcommand_of(app, words.front());
  return fmt::format("{0}: {1}\nTry `{0}{2} --help` for more information.", app.get_name(),
                     explanation(app, words, error), subcommand != nullptr ? " " + words.front() : "");
}

}  // namespace understudy::launcher
