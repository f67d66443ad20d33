// SPDX-License-Identifier: Apache-2.0
// Measures what messages, bytes and blending cost between these ranks at present.
#pragma once

#include "compositor/exchange/communicator.h"
#include "compositor/exchange/cost.h"

namespace understudy::compositor {

/// Collective: measures between rank 0 and the last rank, then between all ranks at once; all ranks get the
/// same result. Takes a few milliseconds, more if many ranks share a processor. A single rank gets the
/// defaults.
MessageCost measure_message_cost(Communicator& communicator);

}  // namespace understudy::compositor
