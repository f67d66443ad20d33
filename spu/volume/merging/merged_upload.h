// SPDX-License-Identifier: Apache-2.0
// The texels of a merged volume on their way to the render nodes.
#pragma once

#include <span>

#include "spu/volume/merging/merged_volume.h"
#include "spu/volume/upload/uploader.h"

namespace understudy::spu {

/// One texture, as it is now.
struct BrickVersion {
  GLuint texture = 0;
  std::uint64_t version = 0;
};

/// Makes what the service holds of `merged` what the textures hold now. `sampled` says the unit that bricks are
/// bound to. Needs the session's lock. Throws as Uploader::upload does.
void upload_merged(const GlContext& context, ShareGroup& group, RenderSession& session, Uploader& uploader,
                   FrameAccount& account, MergedVolume& merged, std::span<const BrickVersion> bricks,
                   const SampledTexture& sampled, compositor::RenderService& service);

}  // namespace understudy::spu
