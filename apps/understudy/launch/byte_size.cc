// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/launch/byte_size.h"

#include <fmt/format.h>

#include <charconv>
#include <limits>
#include <string_view>

namespace understudy::launcher {

std::string to_byte_size(std::string& text) {
  if (text == "auto") return {};
  std::uint64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  const std::string_view unit(rest, std::size_t(end - rest));
  constexpr std::string_view units = "KMGT";
  const std::size_t power = unit.empty() ? 0 : units.find(unit[0]) + 1;
  if (error != std::errc() || unit.size() > 1 || (!unit.empty() && power == 0))
    return fmt::format("'{}' is not a size; give a number of bytes, a whole number with K, M, G or T, or auto",
                       text);
  if (number > std::numeric_limits<std::uint64_t>::max() >> (10 * power))
    return fmt::format("{} is too large", text);
  text = fmt::format("{}", number << (10 * power));
  return {};
}

std::uint64_t byte_size(const std::string& text) {
  std::uint64_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

}  // namespace understudy::launcher
