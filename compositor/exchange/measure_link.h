// What messages, bytes and blending cost between these ranks, now.
#pragma once

#include "compositor/exchange/cost.h"
#include "compositor/exchange/link.h"

namespace understudy::compositor {

/// Collective: measured between rank 0 and the last rank, and then between all ranks at once; the same on all
/// ranks afterwards. Takes a few milliseconds, more where many ranks share a processor. A single rank has the
/// defaults.
LinkCost measure_link(Link& link);

}  // namespace understudy::compositor
