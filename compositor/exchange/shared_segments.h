// SPDX-License-Identifier: Apache-2.0
// Messages that are read in place: each rank has memory that all ranks of its machine map, and it writes there
// what it has for another (Marchesin et al. 2008 composite in memory that a machine's processes share).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "compositor/exchange/communicator.h"
#include "compositor/transport/file_descriptor.h"

namespace understudy::compositor {

class SharedSegments {
 public:
  /// The most memory of one rank; pages are allocated when they are first written, and kept.
  static constexpr std::size_t most_bytes = std::size_t(1) << 30;

  /// Makes memory for the segments of one rank, which other processes find at /proc/PID/fd: most_bytes, or less
  /// if this process has a limited address space (RLIMIT_AS), because each rank maps the memory of all. Throws
  /// std::system_error.
  static FileDescriptor make_memory();

  /// Maps the memories of all ranks, by rank. Throws std::system_error.
  SharedSegments(std::span<const FileDescriptor> memories, Rank mine);
  ~SharedSegments();
  SharedSegments(const SharedSegments&) = delete;
  SharedSegments& operator=(const SharedSegments&) = delete;

  /// Returns memory for a message; empty if there is not enough left.
  std::span<std::byte> segment(std::size_t bytes);
  /// Frees all segments of this rank: no rank reads them any more.
  void clear() { used_ = 0; }

  /// Where bytes lie, as another rank is told.
  struct Place {
    std::uint64_t first = 0;
    std::uint64_t bytes = 0;
  };
  /// Null for bytes that are in no segment of this rank.
  std::optional<Place> place_of(std::span<const std::byte> bytes) const;
  /// Throws RankLost if `place` lies outside the rank's memory.
  std::span<const std::byte> at(Rank rank, Place place) const;

 private:
  std::vector<std::span<std::byte>> memories_;
  Rank mine_;
  std::size_t used_ = 0;
};

}  // namespace understudy::compositor
