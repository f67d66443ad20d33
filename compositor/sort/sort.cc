// SPDX-License-Identifier: Apache-2.0
#include "compositor/sort/sort.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

namespace understudy::compositor {

namespace {

/// Returns the ranks by machine, machines in the order of their first ranks; null if some machines have more
/// ranks than others.
std::optional<std::vector<std::vector<int>>> equal_machines(const std::vector<int>& machines) {
  std::vector<std::vector<int>> ranks;
  std::vector<int> known;
  for (std::size_t rank = 0; rank < machines.size(); ++rank) {
    const auto machine = std::ranges::find(known, machines[rank]) - known.begin();
    if (machine == std::ptrdiff_t(known.size())) {
      known.push_back(machines[rank]);
      ranks.emplace_back();
    }
    ranks[std::size_t(machine)].push_back(int(rank));
  }
  if (std::ranges::any_of(ranks, [&](const auto& local) { return local.size() != ranks.front().size(); }))
    return std::nullopt;
  return ranks;
}

/// Returns the least divisor of `all` that is enough.
template <class IsEnough>
int least_divisor(int all, IsEnough is_enough) {
  for (int divisor = 1; divisor < all; ++divisor)
    if (all % divisor == 0 && is_enough(divisor)) return divisor;
  return std::max(all, 1);
}

/// Whether `settings` allow a copy of `bytes` to be divided among `members` of `all`.
bool is_enough(const SortSettings& settings, int members, int all, std::uint64_t bytes) {
  switch (settings.sort) {
    case Sort::automatic:
      return bytes <= settings.bytes_of_machine * std::uint64_t(members);
    case Sort::first:
      return true;
    case Sort::last:
      return members == all;
    case Sort::hybrid:
      return members * members >= all;
  }
  return false;
}

}  // namespace

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

bool set_partition(SortSettings& settings, std::string_view name) {
  using volume::PartitionMethod;
  constexpr std::array<std::pair<std::string_view, PartitionMethod>, 4> names{
      {{"auto", PartitionMethod::cost},
       {"blocks", PartitionMethod::blocks},
       {"factors", PartitionMethod::factors},
       {"cost", PartitionMethod::cost}}};
  for (const auto& [known, method] : names) {
    if (known != name) continue;
    settings.partition = method;
    return true;
  }
  return false;
}

Arrangement::Arrangement(const SortSettings& settings, const std::vector<int>& machines, std::uint64_t bytes)
    : places_(machines.size()), ranks_(machines.size()) {
  const auto by_machine = equal_machines(machines);
  const int count = by_machine ? int(by_machine->size()) : 0;
  // A copy is divided among machines, and the ranks of a machine are the same member of different groups. If
  // all ranks divide one volume, or machines have different numbers of ranks, each rank counts as a machine.
  const bool of_machines =
      count > 0 && settings.sort != Sort::last && (settings.sort != Sort::hybrid || count > 1);
  const int all = of_machines ? count : ranks();
  members_ = least_divisor(all, [&](int members) {
    // Unequal machines cannot be grouped by memory: a copy is held by one rank, or by all together.
    if (settings.sort == Sort::automatic && !of_machines && members > 1) return false;
    return is_enough(settings, members, all, bytes);
  });
  const auto put = [&](int rank, int group, int member) {
    places_[std::size_t(rank)] = {group, member, rank};
    ranks_[index_of(group, member)] = rank;
  };
  if (of_machines) {
    const int on_each = int(by_machine->front().size());
    for (int machine = 0; machine < count; ++machine)
      for (int i = 0; i < on_each; ++i)
        put((*by_machine)[std::size_t(machine)][std::size_t(i)], machine / members_ * on_each + i,
            machine % members_);
  } else {
    for (int rank = 0; rank < ranks(); ++rank) put(rank, rank / members_, rank % members_);
  }
  for (std::size_t rank = 0; rank < places_.size() && bytes >= settings.least_shared_bytes; ++rank)
    for (std::size_t other = 0; other < rank; ++other)
      if (machines[other] == machines[rank] && places_[other].member == places_[rank].member) {
        places_[rank].keeper = int(other);
        break;
      }
}

int Arrangement::readers(int rank) const {
  return int(std::ranges::count(places_, rank, &Place::keeper));
}

}  // namespace understudy::compositor
