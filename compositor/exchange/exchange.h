// Sort-last compositing: the images of the ranks go in, one picture comes out on rank 0. Plays a schedule
// (which see): whatever the algorithm, this is all that moves and blends pixels.
#pragma once

#include <cstdint>
#include <span>

#include "compositor/exchange/link.h"
#include "compositor/exchange/pixel_layout.h"
#include "compositor/exchange/schedule.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::compositor {

struct Exchanged {
  volume::Image picture;    ///< on rank 0: over Schedule::whole; else empty
  std::uint64_t bytes = 0;  ///< on rank 0: that travelled between all ranks
};

/// Collective over the ranks that the schedule names; the others may call it too. `mine.rect` is this rank's
/// footprint. A single image is not composited, it is the picture. With Layout::rgba32f the picture is that of
/// blending all images front to back, to within 2e-6 for any schedule, and bit for bit under Algorithm::serial
/// and Algorithm::direct_send. Throws LinkLost.
Exchanged exchange(volume::Image mine, const Schedule& schedule, volume::Operator op, Layout layout,
                   Link& link);

}  // namespace understudy::compositor
