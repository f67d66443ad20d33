// SPDX-License-Identifier: Apache-2.0
// The texels of a volume that is stored in several 3-D textures.
#pragma once

#include <memory>
#include <vector>

#include "spu/volume/merging/tiling.h"
#include "spu/volume/texture/texels.h"

namespace understudy::spu {

/// Reads from all `textures`, at their places; binds them to the active unit one after the other. read() throws
/// if two textures have different texels at one place; texels that no texture covers are 0.
std::unique_ptr<TexelSource> merged_source(const GlContext& context, const Tiling& tiling,
                                           std::vector<GLuint> textures,
                                           std::vector<TextureDescription> descriptions);

}  // namespace understudy::spu
