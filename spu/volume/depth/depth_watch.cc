// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/depth/depth_watch.h"

#include <string_view>

#include "spu/report/optimization.h"
#include "spu/state_value.h"
#include "spu/volume/context/context.h"
#include "spu/volume/depth/deferred_depth_write.h"
#include "spu/volume/depth/depth_attachment.h"
#include "spu/volume/session/render_session.h"
#include "spu/volume/timing/frame_account.h"

namespace understudy::spu {

namespace {

/// Describes the depth of the framebuffer bound for drawing.
DeferredDepth::Watched depth_of_framebuffer(const DispatchTable& gl, GLuint volume,
                                            const volume::Rect& pixels) {
  const auto framebuffer = GLuint(state_value(gl, GL_DRAW_FRAMEBUFFER_BINDING));
  const DepthAttachment attachment = depth_attachment(gl, framebuffer);
  return {framebuffer, volume, pixels, attachment.type == GL_TEXTURE, attachment.renderbuffer()};
}

}  // namespace

std::optional<DeferredDepth::Watched> DepthWatch::settle(const Run& run, const volume::Rect& pixels, bool first,
                                                         bool looked_at) {
  if (!run.pipeline().depth_test || !run.pipeline().depth_write) return std::nullopt;
  const std::string_view why = first       ? "the first of the volume"
                               : looked_at ? "somebody looked at it"
                               : session_.disabled_optimizations(Optimization::unseen_depth) ? "asked to"
                                                                                             : "";
  // The visible part comes first: counting may fail.
  if (!why.empty()) {
    // Waits for completion, as when the application's own drawing is timed: a driver that draws later would
    // hide the time that this takes.
    const TimedShare timed(account_.clock(), &FrameShares::presentation);
    write_depth(*context_.gl, run);
    context_.gl->Finish();
  }
  account_.note([&](FrameRecord& frame) {
    Amount& runs = frame.amount(Optimization::unseen_depth);
    ++(why.empty() ? runs.left_out : runs.done);
  });
  if (!why.empty()) count_done(Optimization::unseen_depth, why);
  if (looked_at) return std::nullopt;
  return depth_of_framebuffer(*context_.gl, run.volume_texture(), pixels);
}

}  // namespace understudy::spu
