// SPDX-License-Identifier: Apache-2.0
// Messages that stay where they are: memory of each rank that all ranks of the machine see, so that what one
// has written for another is read in place (Marchesin et al. 2008 composite in memory that a machine's
// processes share).
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
  /// What one rank may have at most; pages are taken when they are first written, and kept.
  static constexpr std::size_t most_bytes = std::size_t(1) << 30;

  /// Memory for the segments of one rank, which other processes find at /proc/PID/fd: of most_bytes, or less
  /// where this process may have few addresses (RLIMIT_AS), as each rank maps the memory of all. Throws
  /// std::system_error.
  static FileDescriptor make_memory();

  /// The memories of all ranks, by rank. Throws std::system_error.
  SharedSegments(std::span<const FileDescriptor> memories, Rank mine);
  ~SharedSegments();
  SharedSegments(const SharedSegments&) = delete;
  SharedSegments& operator=(const SharedSegments&) = delete;

  /// Empty when there is not so much left.
  std::span<std::byte> segment(std::size_t bytes);
  /// Nobody looks at this rank's segments any longer.
  void clear() { used_ = 0; }

  /// Where bytes lie, as another rank may be told.
  struct Place {
    std::uint64_t first = 0;
    std::uint64_t bytes = 0;
  };
  /// Nothing for bytes that are in no segment of this rank.
  std::optional<Place> place_of(std::span<const std::byte> bytes) const;
  /// Throws RankLost when there can be nothing.
  std::span<const std::byte> at(Rank rank, Place place) const;

 private:
  std::vector<std::span<std::byte>> memories_;
  Rank mine_;
  std::size_t used_ = 0;
};

}  // namespace understudy::compositor
