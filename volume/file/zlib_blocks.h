// SPDX-License-Identifier: Apache-2.0
// Data in separately compressed blocks, as in VTK's XML files: each block can be read without the others.
#pragma once

#include <vector>

#include "volume/file/byte_source.h"

namespace understudy::volume {

/// The positions of the blocks, and their uncompressed sizes.
struct ZlibBlockTable {
  std::uint64_t block_bytes = 0;       ///< uncompressed, of all blocks except the last
  std::uint64_t total_bytes = 0;       ///< uncompressed, of all blocks
  std::vector<std::uint64_t> offsets;  ///< of each block in its source, and of the end of the last
};

class ZlibBlocks : public ByteSource {
 public:
  ZlibBlocks(std::shared_ptr<ByteSource> below, ZlibBlockTable table);

  std::size_t read(std::uint64_t offset, std::span<std::byte> to) override;
  std::optional<std::uint64_t> size() const override { return table_.total_bytes; }
  std::uint64_t bytes_from_file() const override { return below_->bytes_from_file(); }
  const std::string& path() const override { return below_->path(); }

 private:
  void unpack(std::size_t block);

  std::shared_ptr<ByteSource> below_;
  ZlibBlockTable table_;
  std::size_t held_;  ///< the uncompressed block in memory; none: the number of blocks
  std::vector<std::byte> packed_;
  std::vector<std::byte> unpacked_;
};

}  // namespace understudy::volume
