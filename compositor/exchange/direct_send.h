// Direct-send: the picture is cut into one strip per rank that shows something; every rank sends each strip's
// owner the part of its image that lies in that strip, the owner blends what it has in visibility order, and
// the finished strips are gathered on rank 0. Hsu 1993; Neumann 1994. Cost (2t + b)(N - 1) / N without
// footprints (Magallon, Hopf, Ertl 2001, section 3.2); here only the overlaps of footprints with strips travel,
// so the bytes follow the footprints.
#pragma once

#include "compositor/exchange/exchange.h"

namespace understudy::compositor {

/// Collective over `link`; `mine.rect` is this rank's footprint. Ranks with an empty footprint send nothing; a
/// single rank with something to show is not composited, its image is the picture. Bit for bit the picture of
/// `serial`. Throws LinkLost.
Exchanged direct_send(volume::Image mine, const Composition& composition, Link& link);

}  // namespace understudy::compositor
