// SPDX-License-Identifier: Apache-2.0
// What ranks may take of memory for volumes.
#pragma once

#include <cstdint>
#include <functional>

namespace understudy::launcher {

struct VolumeMemory {
  std::uint64_t bytes = 0;  ///< that each rank may take for its part of a volume
  /// Whether no process may take more, or only all ranks together should not: ranks of one machine may keep
  /// bricks for each other.
  bool of_each_process = false;
};

/// Once it is known how many ranks there are.
using RankMemory = std::function<VolumeMemory(int ranks)>;

}  // namespace understudy::launcher
