// SPDX-License-Identifier: Apache-2.0
#include "compositor/exchange/shared_segments.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <functional>
#include <system_error>

namespace understudy::compositor {

namespace {

/// Segments begin at cache lines.
constexpr std::size_t alignment = 64;

}  // namespace

FileDescriptor SharedSegments::make_memory() {
  FileDescriptor memory(::memfd_create("understudy messages", MFD_CLOEXEC));
  if (!memory || ::ftruncate(memory.get(), off_t(most_bytes)) != 0)
    throw std::system_error(errno, std::generic_category(), "no memory that ranks could share");
  return memory;
}

SharedSegments::SharedSegments(std::span<const FileDescriptor> memories, Rank mine) : mine_(mine) {
  memories_.reserve(memories.size());
  for (const FileDescriptor& memory : memories) {
    void* const mapped =
        ::mmap(nullptr, most_bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_NORESERVE, memory.get(), 0);
    if (mapped == MAP_FAILED) {
      const int error = errno;
      for (const std::span<std::byte>& done : memories_) ::munmap(done.data(), done.size());
      throw std::system_error(error, std::generic_category(), "the ranks' memory cannot be mapped");
    }
    memories_.emplace_back(static_cast<std::byte*>(mapped), most_bytes);
  }
}

SharedSegments::~SharedSegments() {
  for (const std::span<std::byte>& memory : memories_) ::munmap(memory.data(), memory.size());
}

std::span<std::byte> SharedSegments::segment(std::size_t bytes) {
  if (bytes > most_bytes - used_) return {};
  const std::size_t first = used_;
  used_ = std::min(most_bytes, first + (bytes + alignment - 1) / alignment * alignment);
  return memories_[std::size_t(mine_)].subspan(first, bytes);
}

std::optional<SharedSegments::Place> SharedSegments::place_of(std::span<const std::byte> bytes) const {
  const std::span<const std::byte> own = memories_[std::size_t(mine_)];
  const std::less<> before;
  if (before(bytes.data(), own.data()) || !before(bytes.data(), own.data() + own.size())) return std::nullopt;
  return Place{std::uint64_t(bytes.data() - own.data()), bytes.size()};
}

std::span<const std::byte> SharedSegments::at(Rank rank, Place place) const {
  if (place.first > most_bytes || place.bytes > most_bytes - place.first)
    throw RankLost("a rank told of a message outside the memory that it shares");
  return memories_[std::size_t(rank)].subspan(place.first, place.bytes);
}

}  // namespace understudy::compositor
