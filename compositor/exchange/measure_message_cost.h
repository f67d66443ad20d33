// SPDX-License-Identifier: Apache-2.0
// What messages, bytes and blending cost between these ranks, now.
#pragma once

#include "compositor/exchange/communicator.h"
#include "compositor/exchange/cost.h"

namespace understudy::compositor {

/// Collective: measured between rank 0 and the last rank, and then between all ranks at once; the same on all
/// ranks afterwards. Takes a few milliseconds, more where many ranks share a processor. A single rank has the
/// defaults.
MessageCost measure_message_cost(Communicator& communicator);

}  // namespace understudy::compositor
