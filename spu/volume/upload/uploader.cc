// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/upload/uploader.h"

#include <algorithm>
#include <cmath>

#include "compositor/service.h"
#include "spu/report/counters.h"
#include "spu/report/optimization.h"
#include "spu/track/share_group.h"
#include "spu/volume/budget/budget.h"
#include "spu/volume/context/context.h"
#include "spu/volume/context/saved_state.h"
#include "spu/volume/refusal/refusal.h"
#include "spu/volume/session/render_session.h"
#include "spu/volume/texture/value_range.h"
#include "spu/volume/timing/frame_account.h"
#include "volume/texel_box.h"

namespace understudy::spu {
namespace {

/// Returns the texels of a texture of `size` that samples in `region` read, including the linear filter.
volume::TexelBox texels_of(const volume::Box& region, const std::array<int, 3>& size) {
  volume::TexelBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    const double n = size[k];
    box.low[k] = std::clamp(int(std::floor(region.low[k] * n - 0.5)), 0, size[k] - 1);
    box.high[k] = std::clamp(int(std::floor(region.high[k] * n - 0.5)) + 2, box.low[k] + 1, size[k]);
  }
  return box;
}

/// Returns the region, extended to where the far ends of its segments may lie.
volume::Box with_slice_segments(volume::Box region, std::span<const ObservedSegment> slice_segments) {
  const volume::Box without = region;
  for (const ObservedSegment& observed : slice_segments) {
    for (std::size_t k = 0; k < 3; ++k) {
      region.low[k] = std::min(region.low[k], without.low[k] - observed.slice_segment.reach[k]);
      region.high[k] = std::max(region.high[k], without.high[k] + observed.slice_segment.reach[k]);
    }
  }
  return region;
}

/// Returns the width, in cells, of the ghost layer that nodes need for segments: whole blocks, so that a view
/// that turns requires no new transfer.
int ghost_layer_of(std::span<const ObservedSegment> slice_segments, const std::array<int, 3>& size) {
  double cells = 0;
  for (const ObservedSegment& observed : slice_segments) {
    for (std::size_t k = 0; k < 3; ++k) cells = std::max(cells, observed.slice_segment.reach[k] * size[k]);
  }
  constexpr int block = 8;
  return block * int(std::ceil(cells / block));
}

}  // namespace

TextureDescription Uploader::describe(const Pipeline& pipeline, std::size_t stack_slices) const {
  const DispatchTable& gl = *context_.gl;
  GLint active = 0;
  gl.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
  gl.ActiveTexture(GLenum(GL_TEXTURE0 + pipeline.volume.unit));
  TextureDescription texture;
  auto reason = describe_texture(context_, pipeline.volume.target, pipeline.volume.unit, texture);
  gl.ActiveTexture(GLenum(active));
  if (reason) throw Refusal{*reason};
  if (pipeline.stack) {
    texture.size[2] = int(stack_slices);
    texture.wrap[2] = volume::Wrap::edge;
  }
  return texture;
}

volume::VolumeDescription Uploader::described(const TexelsWanted& wanted, const SentVolume& sent) const {
  const TextureDescription& texture = sent.texture;
  const bool kept = sent.generation == session_.generation();
  volume::VolumeDescription description = sent.description;
  description.size = texture.size;
  description.type = texture.type;
  description.wrap = texture.wrap;
  description.border = texture.border;
  description.stored = texels_of(with_slice_segments(wanted.region, wanted.slice_segments), texture.size);
  description.ghost_layer = std::max(wanted.ghost_layer, ghost_layer_of(wanted.slice_segments, texture.size));
  if (session_.settings().has_budget())
    description.ghost_layer = std::max(description.ghost_layer, budget_ghost_layer);
  if (!kept) return description;
  description.ghost_layer = std::max(description.ghost_layer, sent.description.ghost_layer);
  // If the view showed a part first and shows more now, the whole is sent, once.
  description.stored = volume::contains(sent.description.stored, description.stored)
                           ? sent.description.stored
                           : volume::TexelBox{{0, 0, 0}, texture.size};
  return description;
}

void Uploader::upload(const TexelsWanted& wanted, SentVolume& sent, VolumeCounters& counters,
                      compositor::RenderService& service) {
  const bool kept = sent.generation == session_.generation();
  volume::VolumeDescription description = described(wanted, sent);
  const bool everything = session_.disabled_optimizations(Optimization::unchanged_texels);
  const bool changed_at_most = kept && description == sent.description && !everything;
  if (changed_at_most && sent.texture_version == wanted.texture_version) {
    account_.note([&](FrameRecord& frame) {
      frame.amount(Optimization::unchanged_texels).left_out +=
          volume::texels_in(description.stored) * volume::bytes_per_texel(description.type);
    });
    return;
  }
  const std::string_view why = everything        ? "asked to"
                               : changed_at_most ? "the texture was written to"
                               : kept            ? "more of the texture is shown, or another texture"
                                                 : "the nodes do not have them";

  const TimedShare timed(account_.clock(), &FrameShares::upload);
  sent.generation = 0;
  const Transferred transferred = [&] {
    try {
      return send(wanted, changed_at_most, description, sent, service);
    } catch (...) {
      // The next attempt has another id: what was sent under this one would stay for good.
      if (description.id != 0) session_.forget(description.id);
      throw;
    }
  }();
  sent.range = value_range(sent.texture, sent.hashes.range());
  sent.description = description;
  sent.texture_version = wanted.texture_version;
  sent.generation = session_.generation();
  count(counters, transferred, why);
}

Transferred Uploader::send(const TexelsWanted& wanted, bool only_changes,
                           volume::VolumeDescription& description, SentVolume& sent,
                           compositor::RenderService& service) {
  const SampledTexture& sampled = wanted.pipeline.volume;
  SavedState saved(context_);
  context_.gl->ActiveTexture(GLenum(GL_TEXTURE0 + sampled.unit));
  if (wanted.pipeline.stack) saved.borrow_texture(GL_TEXTURE_2D, sampled.unit);
  const auto source = wanted.pipeline.stack ? stack_source(context_, wanted.stack, sent.texture)
                                            : texture_source(context_, sampled.texture, sent.texture);
  if (only_changes) {
    std::optional<std::vector<volume::TexelBox>> regions;
    if (!wanted.pipeline.stack) regions = group_.changes_since(sampled.texture, sent.texture_version);
    if (!regions) regions = {description.stored};
    return send_changes(service, description, *regions, *source, sent.hashes);
  }
  if (description.id == 0) description.id = session_.new_volume_id();
  ++description.version;
  sent.hashes = BlockHashes(description.stored, description.type);
  return send_volume(service, description, *source, sent.hashes);
}

void Uploader::count(VolumeCounters& counters, const Transferred& transferred, std::string_view why) {
  counters.texel_bytes_sent.fetch_add(transferred.sent, std::memory_order_relaxed);
  counters.texel_bytes_left_out.fetch_add(transferred.left_out, std::memory_order_relaxed);
  account_.note([&](FrameRecord& frame) {
    Amount& texels = frame.amount(Optimization::unchanged_texels);
    texels.done += transferred.sent;
    texels.left_out += transferred.left_out;
  });
  if (transferred.sent > 0) count_done(Optimization::unchanged_texels, why);
}

void count_texture(VolumeCounters& counters, const TextureDescription& texture) {
  for (std::size_t k = 0; k < 3; ++k) counters.size[k] = texture.size[k];
  put_text(counters.texture_format, texture.format_name);
}

}  // namespace understudy::spu
