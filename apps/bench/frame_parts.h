// SPDX-License-Identifier: Apache-2.0
// The work of each rank for one image: the pixels that its box of the volume covers, and the number of samples.
// Either cast as on a node, or derived from the rays alone.
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
  compositor::PixelMask mask;  ///< over the visible part of the rank's image
  volume::Rect cast;           ///< pixels whose rays are set up
  std::uint64_t samples = 0;   ///< samples that are taken
};

struct FrameParts {
  std::vector<compositor::Rank> order;  ///< front first
  std::vector<RankPart> ranks;

  std::uint64_t samples() const;
};

/// Casts each rank's box separately, as RankRenderer does. `texels` are all stored texels of the volume.
FrameParts cast_parts(const volume::VolumeDescription& volume, std::span<const std::byte> texels,
                      const volume::RenderRequest& request, const volume::KdTree& tree);

/// Computes the parts as if every sample of a ray were taken and visible: no brick is empty, and there is no
/// early ray termination. The rays are the nodes' own (volume/raycast/ray_setup.h), with samples on planes or
/// steps. The volume needs no texels, and may exceed any memory.
FrameParts parts_of_rays(const volume::VolumeDescription& volume, const volume::RenderRequest& request,
                         const volume::KdTree& tree);

/// Counts exactly what the nodes send for this image, to the byte.
compositor::CountedExchange counted(const FrameParts& parts, compositor::Algorithm algorithm,
                                    compositor::Gather gather, volume::Operator op, compositor::Layout layout);

}  // namespace understudy::bench
