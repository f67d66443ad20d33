// SPDX-License-Identifier: Apache-2.0
#include "compositor/exchange/shared_segments.h"

#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <functional>
#include <system_error>

namespace understudy::compositor {

namespace {

/// Segments begin at multiples of a cache line.
constexpr std::size_t alignment = 64;

std::size_t bytes_of_a_rank() {
  constexpr std::size_t least = std::size_t(4) << 20;
  constexpr std::size_t part_of_addresses = 64;
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return SharedSegments::most_bytes;
  return std::clamp(std::size_t(limit.rlim_cur) / part_of_addresses / alignment * alignment, least,
                    SharedSegments::most_bytes);
}

/// Returns 0, with errno set, if the size cannot be determined.
std::size_t size_of(const FileDescriptor& memory) {
  struct stat status {};
  return ::fstat(memory.get(), &status) == 0 ? std::size_t(status.st_size) : 0;
}

}  // namespace

FileDescriptor SharedSegments::make_memory() {
  FileDescriptor memory(::memfd_create("understudy messages", MFD_CLOEXEC));
  if (!memory || ::ftruncate(memory.get(), off_t(bytes_of_a_rank())) != 0)
    throw std::system_error(errno, std::generic_category(), "no memory that ranks could share");
  return memory;
}

SharedSegments::SharedSegments(std::span<const FileDescriptor> memories, Rank mine) : mine_(mine) {
  memories_.reserve(memories.size());
  for (const FileDescriptor& memory : memories) {
    const std::size_t bytes = size_of(memory);
    void* const mapped = bytes == 0 ? MAP_FAILED
                                    : ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_NORESERVE,
                                             memory.get(), 0);
    if (mapped == MAP_FAILED) {
      const int error = errno;
      for (const std::span<std::byte>& done : memories_) ::munmap(done.data(), done.size());
      throw std::system_error(error, std::generic_category(), "the ranks' memory cannot be mapped");
    }
    memories_.emplace_back(static_cast<std::byte*>(mapped), bytes);
  }
}

SharedSegments::~SharedSegments() {
  for (const std::span<std::byte>& memory : memories_) ::munmap(memory.data(), memory.size());
}

std::span<std::byte> SharedSegments::segment(std::size_t bytes) {
  const std::span<std::byte> own = memories_[std::size_t(mine_)];
  if (bytes > own.size() - used_) return {};
  const std::size_t first = used_;
  used_ = std::min(own.size(), first + (bytes + alignment - 1) / alignment * alignment);
  return own.subspan(first, bytes);
}

std::optional<SharedSegments::Place> SharedSegments::place_of(std::span<const std::byte> bytes) const {
  const std::span<const std::byte> own = memories_[std::size_t(mine_)];
  const std::less<> before;
  if (before(bytes.data(), own.data()) || !before(bytes.data(), own.data() + own.size())) return std::nullopt;
  return Place{std::uint64_t(bytes.data() - own.data()), bytes.size()};
}

std::span<const std::byte> SharedSegments::at(Rank rank, Place place) const {
  const std::span<std::byte> memory = memories_[std::size_t(rank)];
  if (place.first > memory.size() || place.bytes > memory.size() - place.first)
    throw RankLost("a rank told of a message outside the memory that it shares");
  return memory.subspan(place.first, place.bytes);
}

}  // namespace understudy::compositor
