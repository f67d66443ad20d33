// SPDX-License-Identifier: Apache-2.0
// Volumes that the application divides into many 3-D textures, and draws brick by brick.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "spu/volume/known_volumes/known_volume.h"
#include "spu/volume/merging/tiling.h"
#include "spu/volume/pipeline/pipeline.h"

namespace understudy::spu {

/// A volume of several textures.
struct MergedVolume {
  std::vector<GLuint> textures;
  std::vector<TextureDescription> descriptions;  ///< with which the tiling was found
  std::vector<std::uint64_t> versions;           ///< of the textures whose texels the service has
  std::vector<volume::TexelBox> shown;           ///< texels of each texture that its slices read
  Tiling tiling;
  KnownVolume volume;  ///< the whole; `refusals.handed_back`: reason why it is always drawn brick by brick
  /// Of the frame that began after `frames_at_verdict` frames: why the application draws the bricks. One
  /// verdict holds for all bricks of a frame, because the whole is shown only if none is missing.
  std::optional<Refusal> verdict;
  std::optional<std::uint64_t> frames_at_verdict;

  /// False if the bricks are drawn one by one in the frame after `frames` frames.
  bool shown_as_one(std::uint64_t frames) const {
    return volume.refusals.handed_back.empty() && !volume.refusals.pauses(frames);
  }

  std::optional<std::size_t> place_of(GLuint texture) const;
};

bool alike(const TextureDescription& a, const TextureDescription& b);
/// Returns whether the images of two runs have the same colours, and are blended into the framebuffer the same
/// way.
bool alike(const Pipeline& a, const volume::RenderRequest& first, const Pipeline& b,
           const volume::RenderRequest& second);

}  // namespace understudy::spu
