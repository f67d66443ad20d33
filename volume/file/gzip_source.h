// SPDX-License-Identifier: Apache-2.0
// Decompresses a gzip or zlib stream.
#pragma once

#include <zlib.h>

#include <array>

#include "volume/file/byte_source.h"

namespace understudy::volume {

class GzipSource : public ForwardSource {
 public:
  /// The stream begins at `offset` of `below`, and may have several members. A truncated stream yields fewer
  /// bytes; a damaged one throws FileError.
  GzipSource(std::shared_ptr<ByteSource> below, std::uint64_t offset);
  GzipSource(const GzipSource&) = delete;
  GzipSource& operator=(const GzipSource&) = delete;
  ~GzipSource() override;

 protected:
  void restart() override;
  std::size_t next(std::span<std::byte> to) override;

 private:
  bool refill();
  [[noreturn]] void fail(const char* what) const;

  std::uint64_t start_;
  std::uint64_t from_ = 0;  ///< offset in `below` of the next compressed bytes
  std::array<std::byte, 1U << 16> compressed_{};
  z_stream stream_{};
  bool ended_ = false;
};

}  // namespace understudy::volume
