// Serial compositing: every rank sends its whole image to rank 0, which blends them one after the other, front
// to back. The yardstick of the other exchanges: simplest, and (t + b)(N - 1) slow (Magallon, Hopf, Ertl 2001,
// section 3).
#pragma once

#include "compositor/exchange/exchange.h"

namespace understudy::compositor {

/// Collective over `link`; `mine.rect` is this rank's footprint. Throws LinkLost.
Exchanged serial(volume::Image mine, const Composition& composition, Link& link);

}  // namespace understudy::compositor
