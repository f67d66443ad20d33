// SPDX-License-Identifier: Apache-2.0
// Data in separately compressed blocks, as VTK's XML files have it: any block can be had without the others.
#pragma once

#include <vector>

#include "volume/file/byte_source.h"

namespace understudy::volume {

/// Where the blocks lie and how long they are once they are unpacked.
struct ZlibBlockTable {
  std::uint64_t block_bytes = 0;       ///< unpacked, of all but the last
  std::uint64_t total_bytes = 0;       ///< unpacked, of all together
  std::vector<std::uint64_t> offsets;  ///< of each block in its source, and of the end behind the last
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
  std::size_t held_;  ///< the block that is unpacked; none: their number
  std::vector<std::byte> packed_;
  std::vector<std::byte> unpacked_;
};

}  // namespace understudy::volume
