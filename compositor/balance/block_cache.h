// SPDX-License-Identifier: Apache-2.0
// Blocks that a rank gave away, packed as for sending: a block that comes back need not be sent. Above the byte
// limit the blocks that were put first are dropped.
#pragma once

#include <array>
#include <cstddef>
#include <iterator>
#include <list>
#include <map>
#include <optional>
#include <vector>

#include "volume/texel_box.h"

namespace understudy::compositor {

/// A block's place, counted in blocks from the lattice's low corner.
using BlockPlace = std::array<int, 3>;

class BlockCache {
 public:
  /// Bytes of an entry beside its texels (list, map and allocation): most of the entry if all texels of the
  /// block have one value.
  static constexpr std::size_t entry_bytes = 192;

  explicit BlockCache(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  void put(const BlockPlace& place, std::vector<std::byte> packed);
  bool holds(const BlockPlace& place) const { return entries_.contains(place); }
  /// Removes a block from the cache and returns it.
  std::optional<std::vector<std::byte>> take(const BlockPlace& place);
  /// Removes all blocks in this box, because their texels have changed.
  void drop(const volume::TexelBox& blocks);
  void clear();
  /// Includes entry_bytes for each entry.
  std::size_t bytes() const { return bytes_; }

 private:
  struct Entry {
    BlockPlace place{};
    std::vector<std::byte> packed;
  };
  using Entries = std::list<Entry>;

  void erase(std::map<BlockPlace, Entries::iterator>::iterator entry);

  std::size_t most_bytes_;
  std::size_t bytes_ = 0;
  Entries latest_first_;
  std::map<BlockPlace, Entries::iterator> entries_;
};

}  // namespace understudy::compositor
