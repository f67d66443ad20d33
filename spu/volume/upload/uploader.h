// SPDX-License-Identifier: Apache-2.0
// The stage that brings a texture's texels to the render nodes: once, and then what changes of them.
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

/// What is to be drawn of a texture.
struct TexelsWanted {
  const Pipeline& pipeline;                         ///< which texture, and the unit that it is bound to
  std::span<const GLuint> stack;                    ///< the textures of a stack; empty: one 3-D texture
  std::uint64_t texture_version = 0;                ///< as the texture is now
  volume::Box region;                               ///< of texture space
  std::span<const ObservedSegment> slice_segments;  ///< whose far ends lie outside of it
  int ghost_layer = 0;                              ///< cells that gradients reach
};

class Uploader {
 public:
  Uploader(const GlContext& context, ShareGroup& group, RenderSession& session, FrameAccount& account)
      : context_(context), group_(group), session_(session), account_(account) {}

  /// The pipeline's texture, or its stack of `stack_slices` textures (0: none). Throws Refusal where it is no
  /// volume that can be held.
  TextureDescription describe(const Pipeline& pipeline, std::size_t stack_slices) const;

  /// Makes `sent`, whose `texture` is up to date, what is wanted. Needs the session's lock. Throws Refusal or
  /// std::runtime_error where texels cannot be read, and what the service throws.
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

/// Tells the report of the texture.
void count_texture(VolumeCounters& counters, const TextureDescription& texture);

}  // namespace understudy::spu
