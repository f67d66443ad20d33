// From the application's texture to the nodes: its texels, once, and then what changes of them.
#include <algorithm>
#include <cmath>

#include "spu/track/track.h"
#include "spu/volume/context/saved_state.h"
#include "spu/volume/substitution.h"
#include "spu/volume/upload/texel_transfer.h"
#include "volume/description.h"
#include "volume/texture_space.h"

namespace understudy::spu {
namespace {

/// Texels of `size` that samples of `region` read, linear filter included.
volume::TexelBox texels_of(const volume::Box& region, const std::array<int, 3>& size) {
  volume::TexelBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    const double n = size[k];
    box.low[k] = std::clamp(int(std::floor(region.low[k] * n - 0.5)), 0, size[k] - 1);
    box.high[k] = std::clamp(int(std::floor(region.high[k] * n - 0.5)) + 2, box.low[k] + 1, size[k]);
  }
  return box;
}

/// The region, and where the far ends of its segments may lie.
volume::Box with_slice_segments(volume::Box region, const std::vector<ObservedSegment>& slice_segments) {
  const volume::Box without = region;
  for (const ObservedSegment& observed : slice_segments) {
    for (std::size_t k = 0; k < 3; ++k) {
      region.low[k] = std::min(region.low[k], without.low[k] - observed.slice_segment.reach[k]);
      region.high[k] = std::max(region.high[k], without.high[k] + observed.slice_segment.reach[k]);
    }
  }
  return region;
}

/// Cells around their own that nodes need for segments: whole blocks, so that a view that turns sends nothing
/// anew.
int ghost_layer_of(const std::vector<ObservedSegment>& slice_segments, const std::array<int, 3>& size) {
  double cells = 0;
  for (const ObservedSegment& observed : slice_segments) {
    for (std::size_t k = 0; k < 3; ++k) cells = std::max(cells, observed.slice_segment.reach[k] * size[k]);
  }
  constexpr int block = 8;
  return block * int(std::ceil(cells / block));
}

}  // namespace

void VolumeUnit::describe_volume(Substitution& s) {
  const DispatchTable& gl = *context().gl;
  KnownVolume& known = s.volume;
  GLint active = 0;
  gl.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
  gl.ActiveTexture(GLenum(GL_TEXTURE0 + s.pipeline.volume.unit));
  TextureDescription texture;
  auto reason = describe_texture(context(), s.pipeline.volume.target, s.pipeline.volume.unit, texture);
  gl.ActiveTexture(GLenum(active));
  if (reason) throw Refusal{*reason};
  if (s.pipeline.stack) {
    texture.size[2] = int(s.stack.size());
    texture.wrap[2] = volume::Wrap::edge;
  }
  known.texture = texture;
  for (int k = 0; k < 3; ++k) known.counters->size[k] = texture.size[std::size_t(k)];
  put_text(known.counters->texture_format, texture.format_name);
}

void VolumeUnit::upload(Substitution& s, compositor::RenderService& service) {
  const DispatchTable& gl = *context().gl;
  describe_volume(s);
  KnownVolume& known = s.volume;
  const TextureDescription& texture = known.texture;
  volume::VolumeDescription wanted = known.description;
  wanted.size = texture.size;
  wanted.type = texture.type;
  wanted.wrap = texture.wrap;
  wanted.border = texture.border;
  const bool kept = known.generation == session_->generation();
  wanted.stored = texels_of(with_slice_segments(s.slices.region, s.slice_segments), texture.size);
  wanted.ghost_layer = ghost_layer_of(s.slice_segments, texture.size);
  if (session_->options().has_budget()) wanted.ghost_layer = std::max(wanted.ghost_layer, budget_ghost_layer);
  if (kept) wanted.ghost_layer = std::max(wanted.ghost_layer, known.description.ghost_layer);
  if (kept && volume::contains(known.description.stored, wanted.stored)) {
    wanted.stored = known.description.stored;
  } else if (kept) {
    // The view showed a part first and shows more now: take the whole, once.
    wanted.stored = {{0, 0, 0}, texture.size};
  }
  const bool everything = session_->disabled_optimizations(Optimization::unchanged_texels);
  const bool changed_at_most = kept && wanted == known.description && !everything;
  if (changed_at_most && known.texture_version == s.texture_version) {
    note([&](FrameRecord& frame) {
      frame.amount(Optimization::unchanged_texels).left_out +=
          volume::texels_in(wanted.stored) * volume::bytes_per_texel(wanted.type);
    });
    return;
  }
  const char* const why = everything        ? "asked to"
                          : changed_at_most ? "the texture was written to"
                          : kept            ? "more of the texture is shown, or another texture"
                                            : "the nodes do not have them";

  const TimedShare timed(clock_, &FrameShares::upload);
  known.generation = 0;
  Transferred transferred;
  {
    SavedState saved(context());
    gl.ActiveTexture(GLenum(GL_TEXTURE0 + s.pipeline.volume.unit));
    if (s.pipeline.stack) saved.borrow_texture(GL_TEXTURE_2D, s.pipeline.volume.unit);
    const auto source = s.pipeline.stack ? stack_source(context(), s.stack, texture)
                                         : texture_source(context(), s.pipeline.volume.texture, texture);
    if (changed_at_most) {
      std::optional<std::vector<volume::TexelBox>> regions;
      if (!s.pipeline.stack)
        regions = chain_.group().changes_since(s.pipeline.volume.texture, known.texture_version);
      if (!regions) regions = {wanted.stored};
      transferred = send_changes(service, wanted, *regions, *source, known.hashes);
    } else {
      if (wanted.id == 0) wanted.id = session_->new_volume_id();
      ++wanted.version;
      known.hashes = BlockHashes(wanted.stored, wanted.type);
      transferred = send_volume(service, wanted, *source, known.hashes);
    }
  }
  known.range = value_range(texture, known.hashes.range());
  known.description = wanted;
  known.texture_version = s.texture_version;
  known.generation = session_->generation();
  count_transferred(*known.counters, transferred, why);
}

void VolumeUnit::count_transferred(VolumeCounters& volume, const Transferred& transferred, const char* why) {
  volume.texel_bytes_sent.fetch_add(transferred.sent, std::memory_order_relaxed);
  volume.texel_bytes_left_out.fetch_add(transferred.left_out, std::memory_order_relaxed);
  note([&](FrameRecord& frame) {
    Amount& texels = frame.amount(Optimization::unchanged_texels);
    texels.done += transferred.sent;
    texels.left_out += transferred.left_out;
  });
  if (transferred.sent > 0) count_done(Optimization::unchanged_texels, why);
}

}  // namespace understudy::spu
