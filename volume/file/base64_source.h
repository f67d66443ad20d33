// SPDX-License-Identifier: Apache-2.0
// Decodes base64 text, as written by VTK.
#pragma once

#include <vector>

#include "volume/file/byte_source.h"

namespace understudy::volume {

class Base64Source : public ForwardSource {
 public:
  /// The text begins at `offset` of `below`, optionally after white space, and ends with padding or at the
  /// first other character. White space within the text is skipped.
  Base64Source(std::shared_ptr<ByteSource> below, std::uint64_t offset);

 protected:
  void restart() override;
  std::size_t next(std::span<std::byte> to) override;

 private:
  int next_digit();

  std::uint64_t start_;
  std::uint64_t from_ = 0;
  std::vector<std::byte> text_;
  std::size_t used_ = 0;
  std::uint32_t bits_ = 0;
  int bit_count_ = 0;
  bool ended_ = false;
};

}  // namespace understudy::volume
