// SPDX-License-Identifier: Apache-2.0
// Memory for blocks that several processes of one machine read. One of them makes it and writes; the others map
// it by a path to its descriptor, and read.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace understudy::volume {

class SharedBlocks {
 public:
  SharedBlocks() = default;
  /// For so many bytes, of which pages are taken as they are first written. Throws std::system_error.
  explicit SharedBlocks(std::size_t bytes);
  /// What another process has made, as /proc/PID/fd/N; for reading alone. Throws std::system_error.
  explicit SharedBlocks(const std::string& path);
  ~SharedBlocks();
  SharedBlocks(SharedBlocks&& other) noexcept;
  SharedBlocks& operator=(SharedBlocks&& other) noexcept;

  explicit operator bool() const { return !bytes_.empty(); }
  /// Of what was made here; -1 otherwise.
  int descriptor() const { return descriptor_; }
  std::span<std::byte> bytes() const { return bytes_; }
  /// Takes pages for these bytes now, of what was made here: without, writing to memory that is not there ends
  /// the process. Throws std::bad_alloc.
  void reserve(std::size_t first, std::size_t bytes) const;

 private:
  int descriptor_ = -1;
  std::span<std::byte> bytes_;
};

}  // namespace understudy::volume
