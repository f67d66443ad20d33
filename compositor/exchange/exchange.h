// SPDX-License-Identifier: Apache-2.0
// Sort-last compositing: combines the images of all ranks into one image on rank 0. Executes a schedule
// (schedule.h): for every algorithm, only this code moves and blends pixels.
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
  volume::Image image;      ///< on rank 0: over Schedule::whole, if no memory was given for it; otherwise empty
  std::uint64_t bytes = 0;  ///< on rank 0: sent between all ranks
};

/// Collective over the ranks that the schedule names; the others may call it too. `mine.rect` is this rank's
/// footprint. A single image is not composited, but used as it is. `memory`, if this rank reaches it, is the
/// image buffer: rank 0 writes the image there, and the others write their pieces that are marked as written.
/// Its rows are those of Schedule::whole, bottom up; it is complete when rank 0 returns. With Layout::rgba32f
/// the image is that of blending all images front to back, to within 1e-6 for any schedule, and bit for bit
/// under Algorithm::serial and Algorithm::direct_send. Throws RankLost.
Exchanged exchange(volume::Image mine, const Schedule& schedule, volume::Operator op, Layout layout,
                   Communicator& communicator, std::span<float> memory = {});

}  // namespace understudy::compositor
