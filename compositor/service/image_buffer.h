// SPDX-License-Identifier: Apache-2.0
// The memory in which a node group leaves its image for the application: an anonymous file that the application
// makes and passes along its connection. It is sealed against shrinking, so that neither side can truncate it
// while the other uses it (which would end in SIGBUS); a larger image needs a new one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "compositor/transport/file_descriptor.h"

namespace understudy::compositor {

class ImageBuffer {
 public:
  ImageBuffer() = default;
  ImageBuffer(ImageBuffer&& other) noexcept { *this = std::move(other); }
  ImageBuffer& operator=(ImageBuffer&& other) noexcept;
  ~ImageBuffer();

  /// The application's side: allocates `bytes` of memory. Throws std::runtime_error.
  static ImageBuffer create(std::uint64_t bytes);
  /// The node's side: maps the memory if it is sealed and as large as promised. Throws std::runtime_error.
  static ImageBuffer map(FileDescriptor memory, std::uint64_t bytes);

  std::span<float> floats() const { return {data_, bytes_ / sizeof(float)}; }
  std::size_t bytes() const { return bytes_; }
  int fd() const { return memory_.get(); }
  /// The memory stays mapped.
  void close_descriptor() { memory_.reset(); }

 private:
  ImageBuffer(FileDescriptor memory, std::uint64_t bytes);

  FileDescriptor memory_;
  float* data_ = nullptr;
  std::size_t bytes_ = 0;
};

}  // namespace understudy::compositor
