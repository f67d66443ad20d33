// SPDX-License-Identifier: Apache-2.0
// Whether ranks divide an image (sort-first), a volume (sort-last), or both (hybrid), after the taxonomy of
// Molnar, Cox, Ellsworth, Fuchs 1994.
//
// Ranks form groups with equally many members. A group holds a copy of the volume, which its members divide;
// the groups divide the image. Ranks of one machine that are the same member of their groups need the same
// bricks: one of them keeps these for all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "volume/partition.h"

namespace understudy::compositor {

enum class Sort : std::uint8_t {
  automatic,  ///< a copy is divided among as few machines as have room for it
  first,      ///< every machine holds a copy
  last,       ///< all ranks hold one copy together
  hybrid,     ///< about as many groups as members
};

struct SortSettings {
  Sort sort = Sort::last;
  /// Bytes of texels that a machine may keep, the same on all ranks; for Sort::automatic.
  std::uint64_t bytes_of_machine = 0;
  /// Each rank keeps its own bricks of smaller volumes: sharing costs every rank a descriptor per volume.
  std::uint64_t least_shared_bytes = std::uint64_t(1) << 20;
  /// How the members of a group divide their copy. By cost only if there is one group (Rebalancer).
  volume::PartitionMethod partition = volume::PartitionMethod::blocks;
};

/// Sets the sort: "auto", "first", "last" or "hybrid". Returns false, with `settings` unchanged, for others.
bool set_sort(SortSettings& settings, std::string_view name);
/// Sets the partition: "auto" (by cost), "blocks", "factors" or "cost". Otherwise as set_sort().
bool set_partition(SortSettings& settings, std::string_view name);

/// Group and member of every rank, for one volume.
class Arrangement {
 public:
  struct Place {
    int group = 0;
    int member = 0;
    int keeper = 0;  ///< the rank that keeps this one's bricks
  };

  /// For a volume with `bytes` of texels. `machines` is by rank, as Communicator::machines() returns it.
  Arrangement(const SortSettings& settings, const std::vector<int>& machines, std::uint64_t bytes);

  int ranks() const { return int(places_.size()); }
  int members() const { return members_; }
  int groups() const { return ranks() / members_; }
  const Place& place(int rank) const { return places_[std::size_t(rank)]; }
  int rank_at(int group, int member) const { return ranks_[index_of(group, member)]; }
  /// Returns how many ranks read the bricks that `rank` keeps, itself included; 0: it keeps none.
  int readers(int rank) const;

 private:
  std::size_t index_of(int group, int member) const {
    return std::size_t(group) * std::size_t(members_) + std::size_t(member);
  }

  int members_ = 1;
  std::vector<Place> places_;  ///< by rank
  std::vector<int> ranks_;     ///< by group, then by member
};

}  // namespace understudy::compositor
