// SPDX-License-Identifier: Apache-2.0
// What clients of a node group may ask of each of its ranks, so that no client blocks the others.
#pragma once

#include <chrono>
#include <cstdint>

namespace understudy::compositor {

struct ClientLimits {
  std::uint64_t bytes_in_all = 0;     ///< of texels that a rank holds for all its clients
  std::uint64_t bytes_of_client = 0;  ///< of texels that it holds for one of them
  /// Time limit of one image; 0: none.
  std::chrono::milliseconds image_time{0};
};

/// Returns the most memory that this process could have: the machine's, or the limit of its control group if
/// that is lower, as they were at the first call.
std::uint64_t usable_memory();

/// Returns the memory that the machine could give now without swapping, according to the kernel; 0 if unknown.
std::uint64_t available_memory();

/// Returns the limits of one of `ranks` ranks on this machine. Bricks take half as much again as the texels
/// that they show. With a time limit, clients are independent of each other, and none gets more than half.
ClientLimits client_limits(int ranks, std::chrono::milliseconds image_time);

}  // namespace understudy::compositor
