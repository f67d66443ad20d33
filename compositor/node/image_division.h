// SPDX-License-Identifier: Apache-2.0
// Sort-first: which part of an image each group of ranks draws. All ranks estimate the costs of some tiles,
// exchange them, and cut the image alike. Nothing is kept from image to image: the camera may jump.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "compositor/exchange/communicator.h"
#include "volume/rect.h"

namespace understudy::volume {
struct RenderRequest;
}

namespace understudy::compositor {

class RankRenderer;

/// Whether `mine` is true on all ranks. Collective.
bool all_agree(Communicator& communicator, bool mine);

/// Returns the leaves of `pixels` by group, which have equal costs. Collective; `request` is the same on all
/// ranks, and its volume is complete. A rank that cannot estimate costs counts as one with nothing to draw.
std::vector<volume::Rect> divide_image(Communicator& communicator, RankRenderer& renderer, std::uint64_t client,
                                       const volume::RenderRequest& request, const volume::Rect& pixels);

}  // namespace understudy::compositor
