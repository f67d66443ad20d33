// SPDX-License-Identifier: Apache-2.0
// What the clients of a group of nodes may ask of each of its ranks, so that one of them does not stop the
// others.
#pragma once

#include <chrono>
#include <cstdint>

namespace understudy::compositor {

struct ClientLimits {
  std::uint64_t bytes_in_all = 0;     ///< texels that a rank holds for all its clients
  std::uint64_t bytes_of_client = 0;  ///< for one of them
  /// Of one image; 0: whoever waits for it may do so.
  std::chrono::milliseconds image_time{0};
};

/// What this process could have at most: the machine's memory, or that of the control group it is in, as it was
/// when this was first asked.
std::uint64_t usable_memory();

/// What the kernel says that the machine could give now without swapping; where it does not say, nothing.
std::uint64_t available_memory();

/// Of one of `ranks` ranks on this machine. Bricks take half as much again as the texels that they show.
/// With a limit of time, clients are independent of each other, and none of them gets more than half.
ClientLimits client_limits(int ranks, std::chrono::milliseconds image_time);

}  // namespace understudy::compositor
