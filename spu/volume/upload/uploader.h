// SPDX-License-Identifier: Apache-2.0
// The stage that sends a texture's texels to the render nodes: all of them once, and then those that change.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "spu/volume/geometry/slice_segment.h"
#include "spu/volume/pipeline/pipeline.h"
#include "spu/volume/upload/sent_volume.h"
#include "spu/volume/upload/texel_transfer.h"

namespace understudy::spu {

class FrameAccount;

class RenderSession;
struct VolumeCounters;
}  // namespace understudy::spu

namespace understudy::compositor {
class RenderService;
}

namespace understudy::spu {

class ShareGroup;

struct GlContext;

/// The part of a texture that is to be drawn.
struct TexelsWanted {
  const Pipeline& pipeline;                         ///< identifies the texture, and the unit that it is bound
                                                    ///< to
  std::span<const GLuint> stack;                    ///< the textures of a stack; empty: one 3-D texture
  std::uint64_t texture_version = 0;                ///< current version of the texture
  volume::Box region;                               ///< in texture space
  std::span<const ObservedSegment> slice_segments;  ///< whose far ends may lie outside of `region`
  int ghost_layer = 0;                              ///< cells around the region that gradients need
};

class Uploader {
 public:
  Uploader(const GlContext& context, ShareGroup& group, RenderSession& session, FrameAccount& account)
      : context_(context), group_(group), session_(session), account_(account) {}

  /// Describes the pipeline's texture, or its stack of `stack_slices` textures (0: none). Throws Refusal if it
  /// is not a volume that can be held.
  TextureDescription describe(const Pipeline& pipeline, std::size_t stack_slices) const;

  /// Updates `sent`, whose `texture` is current, to what is wanted. Requires the session's lock. Throws Refusal
  /// or std::runtime_error if texels cannot be read, and what the service throws.
  void upload(const TexelsWanted& wanted, SentVolume& sent, VolumeCounters& counters,
              compositor::RenderService& service);

  void count(VolumeCounters& counters, const Transferred& transferred, std::string_view why);

 private:
  volume::VolumeDescription described(const TexelsWanted& wanted, const SentVolume& sent) const;
  Transferred send(const TexelsWanted& wanted, bool only_changes, volume::VolumeDescription& description,
                   SentVolume& sent, compositor::RenderService& service);

  const GlContext& context_;
  ShareGroup& group_;
  RenderSession& session_;
  FrameAccount& account_;
};

/// Records size and format of the texture for the report.
void count_texture(VolumeCounters& counters, const TextureDescription& texture);

}  // namespace understudy::spu
