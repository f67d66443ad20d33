// SPDX-License-Identifier: Apache-2.0
// A chain as the user writes it: unit names in order, each with its options in parentheses.
//
//   chain  = { unit }
//   unit   = ( name | file ) [ "(" [ option { "," option } ] ")" ]
//   file   = a path that contains a slash, as a value; a unit that is built elsewhere
//   option = name [ "=" value ]                           without a value: "on"
//   value  = characters other than space , ( ) " or, between double quotes, any; there \" is " and \\ is \.
//
//   trace(file=a.ust, level=3) track volume driver
//
// This parser does not check which units and options exist; see assemble.h.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace understudy::spu {

constexpr std::size_t max_chain_bytes = 65536;
constexpr std::size_t max_chain_units = 64;

/// Names the place of an error in a chain, the error, and what is allowed instead.
class ChainError : public std::runtime_error {
 public:
  ChainError(const std::string& where, const std::string& what) : std::runtime_error(where + ": " + what) {}
};

/// An option as written in the text, not checked.
struct OptionSetting {
  std::string name;
  std::string value;
  std::string where;  ///< "chain, character 7"
};

/// A unit as written in the text, with its options in order, not checked.
struct UnitSetting {
  std::string name;
  std::vector<OptionSetting> options;
  std::string where;
};

/// The unit nearest to the application first.
using ChainSettings = std::vector<UnitSetting>;

/// Throws ChainError.
ChainSettings parse_chain(std::string_view text);

/// Returns text that parse_chain() reads as the same chain.
std::string chain_text(const ChainSettings& chain);

/// Returns at most forty characters of a user's text, without control characters, for use in a message.
std::string shown(std::string_view text);

}  // namespace understudy::spu
