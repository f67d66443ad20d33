// SPDX-License-Identifier: Apache-2.0
#include "compositor/balance/block_cache.h"

#include <utility>

namespace understudy::compositor {

namespace {

std::size_t cost(const std::vector<std::byte>& packed) {
  return BlockCache::entry_bytes + packed.size();
}

}  // namespace

void BlockCache::put(const BlockPlace& place, std::vector<std::byte> packed) {
  if (const auto old = entries_.find(place); old != entries_.end()) erase(old);
  bytes_ += cost(packed);
  latest_first_.push_front({place, std::move(packed)});
  entries_[place] = latest_first_.begin();
  while (bytes_ > most_bytes_) erase(entries_.find(latest_first_.back().place));
}

std::optional<std::vector<std::byte>> BlockCache::take(const BlockPlace& place) {
  const auto found = entries_.find(place);
  if (found == entries_.end()) return std::nullopt;
  std::vector<std::byte> packed = std::move(found->second->packed);
  bytes_ -= cost(packed);
  latest_first_.erase(found->second);
  entries_.erase(found);
  return packed;
}

void BlockCache::drop(const volume::TexelBox& blocks) {
  for (auto entry = entries_.begin(); entry != entries_.end();) {
    const auto next = std::next(entry);
    bool inside = true;
    for (std::size_t k = 0; k < 3; ++k)
      inside = inside && entry->first[k] >= blocks.low[k] && entry->first[k] < blocks.high[k];
    if (inside) erase(entry);
    entry = next;
  }
}

void BlockCache::clear() {
  entries_.clear();
  latest_first_.clear();
  bytes_ = 0;
}

void BlockCache::erase(std::map<BlockPlace, Entries::iterator>::iterator entry) {
  bytes_ -= cost(entry->second->packed);
  latest_first_.erase(entry->second);
  entries_.erase(entry);
}

}  // namespace understudy::compositor
