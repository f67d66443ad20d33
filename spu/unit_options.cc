// SPDX-License-Identifier: Apache-2.0
#include "spu/unit_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <numeric>
#include <optional>

namespace understudy::spu {
namespace {

template <typename Number>
std::optional<Number> number_in(std::string_view text, Number low, Number high) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || !(number >= low && number <= high)) return {};
  return number;
}

std::optional<bool> on_or_off(std::string_view text) {
  if (text == "1" || text == "on" || text == "yes" || text == "true") return true;
  if (text == "0" || text == "off" || text == "no" || text == "false") return false;
  return {};
}

std::optional<IntegerRange> range_in(std::string_view text) {
  constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
  const std::size_t dash = text.find('-');
  const auto first = number_in<std::int64_t>(text.substr(0, dash), 0, most);
  if (!first) return {};
  if (dash == std::string_view::npos) return IntegerRange{*first, *first};
  if (dash + 1 == text.size()) return IntegerRange{*first, most};
  const auto last = number_in<std::int64_t>(text.substr(dash + 1), *first, most);
  if (!last) return {};
  return IntegerRange{*first, *last};
}

template <typename Read>
std::optional<OptionValues::Value> as_value(const std::optional<Read>& read) {
  if (!read) return {};
  return OptionValues::Value(*read);
}

std::optional<OptionValues::Value> read_value(const UnitOption& option, const std::string& text) {
  switch (option.type) {
    case OptionType::on_off:
      return as_value(on_or_off(text));
    case OptionType::integer:
      return as_value(number_in<std::int64_t>(text, std::int64_t(option.low), std::int64_t(option.high)));
    case OptionType::number:
      return as_value(number_in<double>(text, option.low, option.high));
    case OptionType::choice:
      if (std::find(option.choices.begin(), option.choices.end(), text) == option.choices.end()) return {};
      return OptionValues::Value(text);
    case OptionType::range:
      return as_value(range_in(text));
    case OptionType::text:
    case OptionType::file:
      if (text.find('\0') != std::string::npos) return {};
      return OptionValues::Value(text);
  }
  return {};
}

/// The number of insertions, deletions and replacements that turn `a` into `b` (Levenshtein).
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string type_text(const UnitOption& option) {
  switch (option.type) {
    case OptionType::on_off:
      return "on or off";
    case OptionType::integer:
      return fmt::format("a whole number from {:.0f} to {:.0f}", option.low, option.high);
    case OptionType::number:
      return fmt::format("a number from {} to {}", option.low, option.high);
    case OptionType::text:
      return "text";
    case OptionType::file:
      return "a file's path";
    case OptionType::choice:
      return fmt::format("one of {}", fmt::join(option.choices, ", "));
    case OptionType::range:
      return "a number or a range: 3, 3-10 or 3-";
  }
  return "";
}

std::string nearest_name(std::string_view wrong, const std::vector<std::string>& names) {
  constexpr std::size_t longest = 40;
  constexpr std::size_t near = 2;
  if (wrong.size() > longest) return "";
  std::string best;
  std::size_t best_distance = near + 1;
  for (const std::string& name : names) {
    const std::size_t apart = distance(wrong, name);
    if (apart < best_distance && apart < name.size()) {
      best = name;
      best_distance = apart;
    }
  }
  return best;
}

bool is_value_of(const UnitOption& option, const std::string& text) {
  return read_value(option, text).has_value();
}

OptionValues option_values(const UnitSetting& unit, std::span<const UnitOption> options) {
  OptionValues values;
  for (const UnitOption& option : options) values.set(option.name, *read_value(option, option.fallback));
  std::vector<std::string> names;
  for (const UnitOption& option : options) names.emplace_back(option.name);
  std::vector<std::string_view> given;
  for (const OptionSetting& setting : unit.options) {
    const auto option = std::find_if(options.begin(), options.end(),
                                     [&](const UnitOption& known) { return setting.name == known.name; });
    if (option == options.end()) {
      const std::string meant = nearest_name(setting.name, names);
      throw ChainError(
          setting.where,
          fmt::format("{} has no option {}{} {}", unit.name, shown(setting.name),
                      meant.empty() ? "." : "; did you mean " + meant + "?",
                      names.empty() ? "It has none" : fmt::format("It has: {}", fmt::join(names, ", "))));
    }
    if (std::find(given.begin(), given.end(), setting.name) != given.end()) {
      throw ChainError(setting.where, fmt::format("the option {} is given twice; keep one", setting.name));
    }
    given.push_back(setting.name);
    const auto value = read_value(*option, setting.value);
    if (!value) {
      throw ChainError(setting.where, fmt::format("{} of {} is {}, not '{}'", option->name, unit.name,
                                                  type_text(*option), shown(setting.value)));
    }
    values.set(setting.name, *value);
  }
  return values;
}

}  // namespace understudy::spu
