// SPDX-License-Identifier: Apache-2.0
// Whether ranks divide an image (sort-first), a volume (sort-last), or both (hybrid), after the taxonomy of
// Molnar, Cox, Ellsworth, Fuchs 1994.
//
// Ranks stand in groups of as many members. A group holds a copy of the volume, which its members divide; the
// groups divide the image. Rank r is member r % members of group r / members.
#pragma once

#include <cstdint>
#include <string_view>

namespace understudy::compositor {

enum class Sort : std::uint8_t {
  automatic,  ///< as few ranks hold a copy as have room for it
  first,      ///< every rank holds a copy
  last,       ///< all ranks hold one copy together
  hybrid,     ///< about as many groups as members
};

struct SortSettings {
  Sort sort = Sort::last;
  /// What copies of one volume's texels may take on a rank, the same on all ranks; for Sort::automatic.
  std::uint64_t bytes_of_copy = 0;
};

/// "auto", "first", "last" or "hybrid". False, with `settings` unchanged, for any other.
bool set_sort(SortSettings& settings, std::string_view name);

/// How many of `ranks` >= 1 ranks hold a copy of `bytes` of texels together: a divisor of `ranks`.
int members_of_group(const SortSettings& settings, int ranks, std::uint64_t bytes);

}  // namespace understudy::compositor
