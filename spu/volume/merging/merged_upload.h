// SPDX-License-Identifier: Apache-2.0
// Sends the texels of a merged volume to the render nodes.
#pragma once

#include <span>

#include "spu/volume/merging/merged_volume.h"
#include "spu/volume/upload/uploader.h"

namespace understudy::spu {

/// A texture and its current version.
struct BrickVersion {
  GLuint texture = 0;
  std::uint64_t version = 0;
};

/// Updates what the service holds of `merged` to the current contents of the textures. `sampled` gives the unit
/// that bricks are bound to. Requires the session's lock. Throws as Uploader::upload does.
void upload_merged(const GlContext& context, ShareGroup& group, RenderSession& session, Uploader& uploader,
                   FrameAccount& account, MergedVolume& merged, std::span<const BrickVersion> bricks,
                   const SampledTexture& sampled, compositor::RenderService& service);

}  // namespace understudy::spu
