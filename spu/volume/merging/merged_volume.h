// SPDX-License-Identifier: Apache-2.0
// Volumes that the application cut into many 3-D textures, and draws brick by brick.
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
  std::vector<TextureDescription> descriptions;  ///< as the tiling was found for
  std::vector<std::uint64_t> versions;           ///< of the textures, whose texels the service has
  std::vector<volume::TexelBox> shown;           ///< of each texture's own texels
  Tiling tiling;
  KnownVolume volume;  ///< the whole; `refusals.handed_back`: why it is drawn brick by brick for good

  std::optional<std::size_t> place_of(GLuint texture) const;
};

bool alike(const TextureDescription& a, const TextureDescription& b);
/// Whether two runs' images go the same way into the framebuffer, in the same colours.
bool alike(const Pipeline& a, const volume::RenderRequest& first, const Pipeline& b,
           const volume::RenderRequest& second);

}  // namespace understudy::spu
