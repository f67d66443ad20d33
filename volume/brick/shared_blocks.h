// SPDX-License-Identifier: Apache-2.0
// Memory for blocks that several processes of one machine read. One process creates it and writes; the others
// map it read-only, by a path to its descriptor.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace understudy::volume {

class SharedBlocks {
 public:
  SharedBlocks() = default;
  /// Creates memory of this size; pages are allocated when first written. Throws std::system_error.
  explicit SharedBlocks(std::size_t bytes);
  /// Maps another process's memory, given as /proc/PID/fd/N, read-only. Throws std::system_error.
  explicit SharedBlocks(const std::string& path);
  ~SharedBlocks();
  SharedBlocks(SharedBlocks&& other) noexcept;
  SharedBlocks& operator=(SharedBlocks&& other) noexcept;

  explicit operator bool() const { return !bytes_.empty(); }
  /// Of memory created here; otherwise -1.
  int descriptor() const { return descriptor_; }
  std::span<std::byte> bytes() const { return bytes_; }
  /// Allocates pages for these bytes of memory created here. Otherwise, writing when no memory is available
  /// terminates the process. Throws std::bad_alloc.
  void reserve(std::size_t first, std::size_t bytes) const;

 private:
  int descriptor_ = -1;
  std::span<std::byte> bytes_;
};

}  // namespace understudy::volume
