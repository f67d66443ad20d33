// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/hosts/slurm_node_list.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>

namespace understudy::launcher {
namespace {

constexpr std::size_t most_names = 4096;
using Names = std::vector<std::string>;

std::optional<unsigned> number(std::string_view text) {
  unsigned value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

/// Expands "01-03,7" to 01, 02, 03, 7, with as many digits as the first number of a range has.
std::optional<Names> numbers_in_brackets(std::string_view text) {
  Names found;
  for (;;) {
    const std::size_t comma = text.find(',');
    const std::string_view part = text.substr(0, comma);
    const std::size_t dash = part.find('-');
    const std::string_view low = part.substr(0, dash);
    const std::optional<unsigned> first = number(low);
    const std::optional<unsigned> last = dash == std::string_view::npos ? first : number(part.substr(dash + 1));
    if (!first || !last || *last < *first || *last - *first >= most_names - found.size()) return {};
    for (unsigned value = *first; value <= *last; ++value)
      found.push_back(fmt::format("{:0{}}", value, low.size()));
    if (comma == std::string_view::npos) return found;
    text.remove_prefix(comma + 1);
  }
}

/// Expands one entry between commas, which may have several pairs of brackets.
std::optional<Names> names_of_entry(std::string_view entry) {
  const std::size_t open = entry.find('[');
  if (open == std::string_view::npos) return entry.empty() ? std::optional<Names>() : Names{std::string(entry)};
  const std::size_t close = entry.find(']', open);
  if (close == std::string_view::npos) return {};
  const std::optional<Names> numbers = numbers_in_brackets(entry.substr(open + 1, close - open - 1));
  if (!numbers) return {};
  Names ends{""};
  if (close + 1 < entry.size()) {
    const std::optional<Names> rest = names_of_entry(entry.substr(close + 1));
    if (!rest) return {};
    ends = *rest;
  }
  if (numbers->size() * ends.size() > most_names) return {};
  Names names;
  for (const std::string& middle : *numbers)
    for (const std::string& end : ends)
      names.push_back(fmt::format("{}{}{}", entry.substr(0, open), middle, end));
  return names;
}

}  // namespace

std::vector<std::string> slurm_nodes(std::string_view list) {
  Names names;
  while (!list.empty()) {
    std::size_t end = 0;
    for (bool inside = false; end < list.size() && (inside || list[end] != ','); ++end)
      inside = list[end] == '[' || (inside && list[end] != ']');
    const std::optional<Names> entry = names_of_entry(list.substr(0, end));
    if (!entry || names.size() + entry->size() > most_names) return {};
    names.insert(names.end(), entry->begin(), entry->end());
    list.remove_prefix(end < list.size() ? end + 1 : end);
  }
  return names;
}

}  // namespace understudy::launcher
