// SPDX-License-Identifier: Apache-2.0
#include "volume/brick/shared_blocks.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <new>
#include <system_error>
#include <utility>

namespace understudy::volume {

namespace {

std::span<std::byte> mapped(int descriptor, std::size_t bytes, int protection) {
  void* const memory = ::mmap(nullptr, bytes, protection, MAP_SHARED | MAP_NORESERVE, descriptor, 0);
  if (memory == MAP_FAILED)
    throw std::system_error(errno, std::generic_category(), "memory for blocks cannot be mapped");
  // Requests large pages, for systems that grant them on request only; failure is ignored.
  ::madvise(memory, bytes, MADV_HUGEPAGE);
  return {static_cast<std::byte*>(memory), bytes};
}

}  // namespace

SharedBlocks::SharedBlocks(std::size_t bytes) {
  const int descriptor = ::memfd_create("understudy blocks", MFD_CLOEXEC);
  if (descriptor < 0)
    throw std::system_error(errno, std::generic_category(), "there is no memory that processes could share");
  descriptor_ = descriptor;
  try {
    if (::ftruncate(descriptor, off_t(bytes)) != 0)
      throw std::system_error(errno, std::generic_category(), "memory for blocks cannot be made");
    bytes_ = mapped(descriptor, bytes, PROT_READ | PROT_WRITE);
  } catch (...) {
    ::close(descriptor);
    throw;
  }
}

SharedBlocks::SharedBlocks(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0)
    throw std::system_error(errno, std::generic_category(), "the blocks of another process cannot be opened");
  try {
    struct stat status {};
    if (::fstat(descriptor, &status) != 0 || status.st_size <= 0)
      throw std::system_error(errno, std::generic_category(), "the blocks of another process have no size");
    bytes_ = mapped(descriptor, std::size_t(status.st_size), PROT_READ);
  } catch (...) {
    ::close(descriptor);
    throw;
  }
  ::close(descriptor);
}

void SharedBlocks::reserve(std::size_t first, std::size_t bytes) const {
  if (::fallocate(descriptor_, 0, off_t(first), off_t(bytes)) != 0) throw std::bad_alloc();
}

SharedBlocks::~SharedBlocks() {
  if (!bytes_.empty()) ::munmap(bytes_.data(), bytes_.size());
  if (descriptor_ >= 0) ::close(descriptor_);
}

SharedBlocks::SharedBlocks(SharedBlocks&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), bytes_(std::exchange(other.bytes_, {})) {}

SharedBlocks& SharedBlocks::operator=(SharedBlocks&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

}  // namespace understudy::volume
