// SPDX-License-Identifier: Apache-2.0
// Stores on one machine that hold the same cells: one writes its blocks to memory that the others read.
//
// Layout of the memory: for each block its offset; the ranges of all blocks; the blocks.
#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "volume/brick/brick_store.h"

namespace understudy::volume {

namespace {

using Offset = std::uint64_t;

constexpr std::size_t cache_line = 64;
/// A sample may read this many bytes beyond the last block.
constexpr std::size_t read_beyond = 64;

std::size_t at_cache_line(std::size_t bytes) {
  return (bytes + cache_line - 1) / cache_line * cache_line;
}

}  // namespace

std::size_t BrickStore::shared_ranges_at() const {
  return at_cache_line(blocks_.size() * sizeof(Offset));
}

std::size_t BrickStore::shared_blocks_at() const {
  return at_cache_line(shared_ranges_at() + ranges_.size() * sizeof(Range));
}

std::size_t BrickStore::shared_bytes() const {
  // Blocks never need more storage than one place each.
  return shared_blocks_at() + blocks_.size() * block_bytes_ + read_beyond;
}

void BrickStore::share() {
  if (finished_ || !chunks_.empty()) throw std::logic_error("a store is shared before texels come");
  if (blocks_.empty()) return;
  shared_ = SharedBlocks(shared_bytes());
  shared_.reserve(0, shared_blocks_at());
}

std::byte* BrickStore::allocate_shared_block() {
  const std::size_t first = shared_blocks_at() + shared_used_ * block_bytes_;
  if (shared_used_ % blocks_per_chunk == 0)
    shared_.reserve(first, std::min(blocks_per_chunk * block_bytes_, shared_bytes() - first));
  ++shared_used_;
  return shared_.bytes().data() + first;
}

void BrickStore::publish() {
  if (!shared_) return;
  std::byte* const memory = shared_.bytes().data();
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const auto offset = Offset(blocks_[b] - memory);
    std::memcpy(memory + b * sizeof offset, &offset, sizeof offset);
  }
  std::memcpy(memory + shared_ranges_at(), ranges_.data(), ranges_.size() * sizeof(Range));
}

void BrickStore::read_blocks_of(const std::string& path) {
  layers_.clear();
  finished_ = true;
  if (blocks_.empty()) return;
  if (!shared_) shared_ = SharedBlocks(path);
  const std::span<const std::byte> memory = shared_.bytes();
  if (memory.size() != shared_bytes())
    throw std::invalid_argument("the blocks that are shared are of another store");
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    Offset offset = 0;
    std::memcpy(&offset, memory.data() + b * sizeof offset, sizeof offset);
    if (offset < shared_blocks_at() || offset > memory.size() - block_bytes_ - read_beyond)
      throw std::invalid_argument("a block that is shared lies outside the memory for blocks");
    blocks_[b] = memory.data() + offset;
  }
  std::memcpy(ranges_.data(), memory.data() + shared_ranges_at(), ranges_.size() * sizeof(Range));
}

}  // namespace understudy::volume
