// SPDX-License-Identifier: Apache-2.0
#include "volume/file/zlib_blocks.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>

#include "volume/file/file_error.h"

namespace understudy::volume {

ZlibBlocks::ZlibBlocks(std::shared_ptr<ByteSource> below, ZlibBlockTable table)
    : below_(std::move(below)), table_(std::move(table)), held_(table_.offsets.size() - 1) {}

std::size_t ZlibBlocks::read(std::uint64_t offset, std::span<std::byte> to) {
  std::size_t filled = 0;
  while (filled < to.size() && offset + filled < table_.total_bytes) {
    const std::uint64_t at = offset + filled;
    const auto block = std::size_t(at / table_.block_bytes);
    if (block != held_) unpack(block);
    const auto in_block = std::size_t(at % table_.block_bytes);
    const std::size_t count = std::min(to.size() - filled, unpacked_.size() - in_block);
    std::copy_n(unpacked_.begin() + std::ptrdiff_t(in_block), count, to.begin() + std::ptrdiff_t(filled));
    filled += count;
  }
  return filled;
}

void ZlibBlocks::unpack(std::size_t block) {
  const std::size_t blocks = table_.offsets.size() - 1;
  held_ = blocks;
  packed_.resize(std::size_t(table_.offsets[block + 1] - table_.offsets[block]));
  if (below_->read(table_.offsets[block], packed_) != packed_.size())
    throw FileError(fmt::format("{}: truncated: it ends within compressed block {} of {}; get the file again",
                                path(), block + 1, blocks));
  unpacked_.resize(std::size_t(
      std::min(table_.block_bytes, table_.total_bytes - std::uint64_t(block) * table_.block_bytes)));
  uLongf length = unpacked_.size();
  if (uncompress(reinterpret_cast<Bytef*>(unpacked_.data()), &length,
                 reinterpret_cast<const Bytef*>(packed_.data()), packed_.size()) != Z_OK ||
      length != unpacked_.size())
    throw FileError(
        fmt::format("{}: compressed block {} of {} is damaged; get the file again", path(), block + 1, blocks));
  held_ = block;
}

}  // namespace understudy::volume
