// SPDX-License-Identifier: Apache-2.0
// Memory limits of the ranks for volumes.
#pragma once

#include <cstdint>
#include <functional>

namespace understudy::launcher {

struct VolumeMemory {
  std::uint64_t bytes = 0;  ///< limit of each rank for its part of a volume
  /// Whether the limit applies to each process; otherwise only to the sum over all ranks, because ranks of one
  /// machine may keep bricks for each other.
  bool of_each_process = false;
};

/// Returns the limits once the number of ranks is known.
using RankMemory = std::function<VolumeMemory(int ranks)>;

}  // namespace understudy::launcher
