// SPDX-License-Identifier: Apache-2.0
// Ranks as threads of one process: tests run whole node groups with it, without MPI.
#pragma once

#include <functional>

#include "compositor/exchange/communicator.h"

namespace understudy::compositor {

/// Runs `body` once per rank, each on a thread of its own, and returns when all have ended. Rethrows the first
/// exception of any rank; the other ranks then get RankLost instead of waiting for ever. With `share_memory`
/// they read each other's segments in place, as ranks of one machine do.
void run_ranks(int ranks, const std::function<void(Communicator&)>& body, bool share_memory = true);

}  // namespace understudy::compositor
