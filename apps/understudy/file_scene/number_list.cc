// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/file_scene/number_list.h"

#include <fmt/format.h>

#include <charconv>
#include <stdexcept>

namespace understudy::launcher {

std::vector<double> numbers(const std::string& text, char separator, std::size_t count, const char* example,
                            std::size_t more) {
  std::vector<double> values;
  const char* at = text.data();
  const char* const end = at + text.size();
  for (bool good = true; good && at < end;) {
    double value = 0;
    const auto [stop, error] = std::from_chars(at, end, value);
    good = error == std::errc() && (stop == end || (*stop == separator && stop + 1 != end));
    if (good) values.push_back(value);
    if (!good) values.clear();
    at = stop == end ? end : stop + 1;
  }
  if (values.size() < count || values.size() > count + more)
    throw std::invalid_argument(
        fmt::format("'{}' is not a list of {} numbers, as in {}", text, count, example));
  return values;
}

}  // namespace understudy::launcher
