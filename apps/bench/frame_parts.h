// SPDX-License-Identifier: Apache-2.0
// What one image asks of each rank: which pixels its box of the volume reaches, with how many samples. Cast
// as a node would cast it, or told from the rays alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "compositor/exchange/counted_exchange.h"
#include "compositor/exchange/schedule.h"
#include "compositor/exchange/settings.h"
#include "volume/blending_operator.h"
#include "volume/description.h"
#include "volume/kd_tree.h"
#include "volume/rect.h"

namespace understudy::volume {
struct RenderRequest;
}

namespace understudy::bench {

struct RankPart {
  compositor::PixelMask mask;  ///< over what shows of its image
  volume::Rect cast;           ///< pixels whose rays are set up
  std::uint64_t samples = 0;   ///< that are taken
};

struct FrameParts {
  std::vector<compositor::Rank> order;  ///< front first
  std::vector<RankPart> ranks;

  std::uint64_t samples() const;
};

/// Casts each rank's box by itself, as RankRenderer does. `texels` are all that the volume stores.
FrameParts cast_parts(const volume::VolumeDescription& volume, std::span<const std::byte> texels,
                      const volume::RenderRequest& request, const volume::KdTree& tree);

/// As if every sample of a ray were taken and showed something: no brick is empty, and there is no early ray
/// termination. The rays are the nodes' own (volume/raycast/ray_setup.h), for samples on planes or steps; the
/// volume needs no texels, and may be larger than any memory.
FrameParts parts_of_rays(const volume::VolumeDescription& volume, const volume::RenderRequest& request,
                         const volume::KdTree& tree);

/// What the nodes send for this image, to the byte.
compositor::CountedExchange counted(const FrameParts& parts, compositor::Algorithm algorithm,
                                    compositor::Gather gather, volume::Operator op, compositor::Layout layout);

}  // namespace understudy::bench
