// SPDX-License-Identifier: Apache-2.0
// The options that a unit declares, and the values that a chain gives them.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "spu/chain_text.h"

namespace understudy::spu {

/// The kind of text that an option accepts.
enum class OptionType {
  on_off,   ///< on, yes, true, 1; off, no, false, 0; the name alone means "on"
  integer,  ///< within low and high
  number,   ///< within low and high
  text,
  file,    ///< a path; the launcher makes it absolute
  choice,  ///< one of `choices`
  range,   ///< "3", "3-10" or "3-": whole numbers from 0
};

/// One option of a unit, as `understudy units` lists it.
struct UnitOption {
  const char* name;
  OptionType type;
  const char* fallback;  ///< the default, as text
  double low = 0;
  double high = 0;
  std::span<const char* const> choices = {};
  const char* help;
};

/// Whole numbers from `first` to `last`.
struct IntegerRange {
  std::int64_t first = 0;
  std::int64_t last = 0;  ///< inclusive
  bool operator==(const IntegerRange&) const = default;
};

/// Every option of a unit with its value from the chain, or the default.
class OptionValues {
 public:
  using Value = std::variant<bool, std::int64_t, double, std::string, IntegerRange>;

  bool is_on(std::string_view name) const { return std::get<bool>(value(name)); }
  std::int64_t integer(std::string_view name) const { return std::get<std::int64_t>(value(name)); }
  double number(std::string_view name) const { return std::get<double>(value(name)); }
  /// The value of a text, a file or a choice.
  const std::string& text(std::string_view name) const { return std::get<std::string>(value(name)); }
  IntegerRange range(std::string_view name) const { return std::get<IntegerRange>(value(name)); }

  void set(std::string name, Value value) { values_.insert_or_assign(std::move(name), std::move(value)); }

 private:
  const Value& value(std::string_view name) const { return values_.find(name)->second; }

  std::map<std::string, Value, std::less<>> values_;
};

/// Whether the option accepts `text`.
bool is_value_of(const UnitOption& option, const std::string& text);

/// Checks the settings of `unit` against its declared `options` and returns all values. Throws ChainError.
OptionValues option_values(const UnitSetting& unit, std::span<const UnitOption> options);

/// "a whole number from 1 to 9", "one of json, text".
std::string type_text(const UnitOption& option);

/// Returns the name in `names` that is closest to the misspelt `wrong`; empty if none is close.
std::string nearest_name(std::string_view wrong, const std::vector<std::string>& names);

}  // namespace understudy::spu
