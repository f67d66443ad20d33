// SPDX-License-Identifier: Apache-2.0
// What base64 text stands for, as VTK writes it.
#pragma once

#include <vector>

#include "volume/file/byte_source.h"

namespace understudy::volume {

class Base64Source : public ForwardSource {
 public:
  /// The text begins at `offset` of `below`, after white space if there is any, and ends with padding or where
  /// the first other character stands. White space within is passed over.
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
