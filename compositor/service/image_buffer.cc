// SPDX-License-Identifier: Apache-2.0
#include "compositor/service/image_buffer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace understudy::compositor {

ImageBuffer::ImageBuffer(FileDescriptor memory, std::uint64_t bytes) : memory_(std::move(memory)) {
  void* data = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, memory_.get(), 0);
  if (data == MAP_FAILED)
    throw std::runtime_error(
        fmt::format("cannot map {} bytes of an image buffer: {}", bytes, std::strerror(errno)));
  data_ = static_cast<float*>(data);
  bytes_ = std::size_t(bytes);
}

ImageBuffer& ImageBuffer::operator=(ImageBuffer&& other) noexcept {
  std::swap(memory_, other.memory_);
  std::swap(data_, other.data_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

ImageBuffer::~ImageBuffer() {
  if (data_ != nullptr) ::munmap(data_, bytes_);
}

ImageBuffer ImageBuffer::create(std::uint64_t bytes) {
  FileDescriptor memory(::memfd_create("understudy image", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  // fallocate(), not ftruncate(): lack of memory must fail here, not at the first write.
  if (!memory || ::fallocate(memory.get(), 0, 0, off_t(bytes)) != 0 ||
      ::fcntl(memory.get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0)
    throw std::runtime_error(
        fmt::format("cannot make {} bytes of an image buffer: {}", bytes, std::strerror(errno)));
  return {std::move(memory), bytes};
}

ImageBuffer ImageBuffer::map(FileDescriptor memory, std::uint64_t bytes) {
  if (!memory) throw std::runtime_error("an image buffer was announced but no descriptor came along");
  const int seals = ::fcntl(memory.get(), F_GET_SEALS);
  if (seals < 0 || (seals & F_SEAL_SHRINK) == 0)
    throw std::runtime_error("the image buffer is not sealed against shrinking");
  struct stat status {};
  if (::fstat(memory.get(), &status) != 0 || std::uint64_t(status.st_size) < bytes)
    throw std::runtime_error(fmt::format("the image buffer is smaller than the {} bytes promised", bytes));
  return {std::move(memory), bytes};
}

}  // namespace understudy::compositor
