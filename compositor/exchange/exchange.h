// SPDX-License-Identifier: Apache-2.0
// Sort-last compositing: the images of the ranks go in, one image comes out on rank 0. Plays a schedule
// (which see): whatever the algorithm, this is all that moves and blends pixels.
#pragma once

#include <cstdint>
#include <span>

#include "compositor/exchange/communicator.h"
#include "compositor/exchange/pixel_layout.h"
#include "compositor/exchange/schedule.h"
#include "volume/blending_operator.h"
#include "volume/image.h"

namespace understudy::compositor {

struct Exchanged {
  volume::Image image;      ///< on rank 0: over Schedule::whole, where no memory was given for it; else empty
  std::uint64_t bytes = 0;  ///< on rank 0: that travelled between all ranks
};

/// Collective over the ranks that the schedule names; the others may call it too. `mine.rect` is this rank's
/// footprint. A single image is not composited, it is the image. `memory`, where this rank reaches it, is
/// where the image goes on rank 0 and where pieces marked as written go on the others: rows of
/// Schedule::whole, bottom up; all of it is there when rank 0 returns. With Layout::rgba32f the image is that
/// of blending all images front to back, to within 1e-6 for any schedule, and bit for bit under
/// Algorithm::serial and Algorithm::direct_send. Throws RankLost.
Exchanged exchange(volume::Image mine, const Schedule& schedule, volume::Operator op, Layout layout,
                   Communicator& communicator, std::span<float> memory = {});

}  // namespace understudy::compositor
