// SPDX-License-Identifier: Apache-2.0
#include "compositor/scene/json_fields.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "compositor/scene/exported_scene.h"

namespace understudy::compositor {

void fail_at(const std::string& key, std::string_view what) {
  throw SceneError(fmt::format("'{}' {}", key, what));
}

std::size_t place_of(const Json& word, std::span<const char* const> known, const std::string& key) {
  const auto found =
      word.is_string() ? std::ranges::find(known, word.get_ref<const std::string&>()) : known.end();
  if (found == known.end()) fail_at(key, fmt::format("is none of: {}", fmt::join(known, ", ")));
  return std::size_t(found - known.begin());
}

std::int64_t JsonReader::integer(const Json& from, std::int64_t low, std::int64_t high,
                                 const std::string& key) {
  if (!from.is_number_integer()) fail_at(key, "is not an integer");
  // Unsigned numbers beyond the range of int64 would wrap.
  const bool huge = from.is_number_unsigned() &&
                    from.get<std::uint64_t>() > std::uint64_t(std::numeric_limits<std::int64_t>::max());
  const std::int64_t value = huge ? std::numeric_limits<std::int64_t>::max() : from.get<std::int64_t>();
  if (value < low || value > high) fail_at(key, fmt::format("is outside {} to {}", low, high));
  return value;
}

}  // namespace understudy::compositor
