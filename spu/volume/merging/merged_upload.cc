// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/merging/merged_upload.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "compositor/service.h"
#include "spu/report/optimization.h"
#include "spu/track/share_group.h"
#include "spu/volume/context/context.h"
#include "spu/volume/context/saved_state.h"
#include "spu/volume/merging/merged_texels.h"
#include "spu/volume/session/render_session.h"
#include "spu/volume/timing/frame_account.h"
#include "volume/texel_box.h"

namespace understudy::spu {
namespace {

/// Returns boxes of the whole volume in which texels may differ from those sent, which have `merged.versions`.
std::vector<volume::TexelBox> changed_texels(ShareGroup& group, const MergedVolume& merged,
                                             std::span<const BrickVersion> bricks) {
  std::vector<volume::TexelBox> changed;
  for (const BrickVersion& brick : bricks) {
    const std::size_t i = *merged.place_of(brick.texture);
    if (brick.version == merged.versions[i]) continue;
    const volume::TexelBox all{{0, 0, 0}, merged.descriptions[i].size};
    const auto told = group.changes_since(brick.texture, merged.versions[i]);
    for (volume::TexelBox box : told ? *told : std::vector{all}) {
      for (std::size_t k = 0; k < 3; ++k) {
        box.low[k] += merged.tiling.places[i].origin[k];
        box.high[k] += merged.tiling.places[i].origin[k];
      }
      box = volume::intersection(box, merged.tiling.places[i].texels);
      if (!volume::is_empty(box)) changed.push_back(box);
    }
  }
  return changed;
}

volume::VolumeDescription described(const MergedVolume& merged, RenderSession& session) {
  const SentVolume& whole = merged.volume.sent;
  volume::VolumeDescription description = whole.description;
  description.size = merged.tiling.size;
  description.type = whole.texture.type;
  description.wrap = whole.texture.wrap;
  description.border = whole.texture.border;
  description.stored = {{0, 0, 0}, description.size};
  if (session.settings().has_budget())
    description.ghost_layer = std::max(description.ghost_layer, budget_ghost_layer);
  if (description.id == 0) description.id = session.new_volume_id();
  return description;
}

}  // namespace

void upload_merged(const GlContext& context, ShareGroup& group, RenderSession& session, Uploader& uploader,
                   FrameAccount& account, MergedVolume& merged, std::span<const BrickVersion> bricks,
                   const SampledTexture& sampled, compositor::RenderService& service) {
  SentVolume& whole = merged.volume.sent;
  volume::VolumeDescription wanted = described(merged, session);
  const bool kept =
      whole.generation == session.generation() && wanted.ghost_layer == whole.description.ghost_layer;
  const std::vector<volume::TexelBox> changed = changed_texels(group, merged, bricks);
  std::vector<std::uint64_t> versions = merged.versions;
  for (const BrickVersion& brick : bricks) versions[*merged.place_of(brick.texture)] = brick.version;
  const bool everything = session.disabled_optimizations(Optimization::unchanged_texels);
  if (kept && changed.empty() && !everything) {
    account.note([&](FrameRecord& frame) {
      frame.amount(Optimization::unchanged_texels).left_out +=
          volume::texels_in(whole.description.stored) * volume::bytes_per_texel(whole.description.type);
    });
    merged.versions = std::move(versions);
    return;
  }
  const TimedShare timed(account.clock(), &FrameShares::upload);
  whole.generation = 0;
  Transferred transferred;
  try {
    SavedState saved(context);
    saved.borrow_texture(GL_TEXTURE_3D, sampled.unit);
    const auto source = merged_source(context, merged.tiling, merged.textures, merged.descriptions);
    if (kept && !everything) {
      transferred = send_changes(service, wanted, changed, *source, whole.hashes);
    } else {
      ++wanted.version;
      whole.hashes = BlockHashes(wanted.stored, wanted.type);
      transferred = send_volume(service, wanted, *source, whole.hashes);
    }
  } catch (const std::runtime_error&) {
    // Only a part of the texels may have arrived.
    session.forget(wanted.id);
    throw;
  }
  whole.description = wanted;
  whole.generation = session.generation();
  merged.versions = std::move(versions);
  uploader.count(*merged.volume.counters, transferred,
                 everything ? "asked to"
                 : kept     ? "a texture was written to"
                            : "the nodes do not have them");
}

}  // namespace understudy::spu
