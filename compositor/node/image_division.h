// SPDX-License-Identifier: Apache-2.0
// Sort-first: which part of an image each group of ranks draws. All ranks estimate the cost of some tiles, tell
// each other, and cut the image alike. Nothing is kept from image to image: the camera may jump.
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

/// Whether all ranks say yes. Collective.
bool all_agree(Communicator& communicator, bool mine);

/// By group: the leaves of `pixels` that cost the same. Collective; `request` is the same on all ranks, and of
/// a complete volume. A rank that cannot estimate counts as one that has nothing to draw.
std::vector<volume::Rect> divide_image(Communicator& communicator, RankRenderer& renderer, std::uint64_t client,
                                       const volume::RenderRequest& request, const volume::Rect& pixels);

}  // namespace understudy::compositor
