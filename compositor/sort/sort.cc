// SPDX-License-Identifier: Apache-2.0
#include "compositor/sort/sort.h"

#include <array>
#include <utility>

namespace understudy::compositor {

bool set_sort(SortSettings& settings, std::string_view name) {
  constexpr std::array<std::pair<std::string_view, Sort>, 4> names{
      {{"auto", Sort::automatic}, {"first", Sort::first}, {"last", Sort::last}, {"hybrid", Sort::hybrid}}};
  for (const auto& [known, sort] : names) {
    if (known != name) continue;
    settings.sort = sort;
    return true;
  }
  return false;
}

int members_of_group(const SortSettings& settings, int ranks, std::uint64_t bytes) {
  const auto is_enough = [&](int members) {
    switch (settings.sort) {
      case Sort::automatic:
        return bytes <= settings.bytes_of_copy * std::uint64_t(members);
      case Sort::first:
        return true;
      case Sort::last:
        return members == ranks;
      case Sort::hybrid:
        return members * members >= ranks;
    }
    return false;
  };
  for (int members = 1; members < ranks; ++members)
    if (ranks % members == 0 && is_enough(members)) return members;
  return ranks;
}

}  // namespace understudy::compositor
