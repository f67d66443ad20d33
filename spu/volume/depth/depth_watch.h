// SPDX-License-Identifier: Apache-2.0
// Decides when the depth that substituted slices would have written is drawn (deferred_depth_write.h).
#pragma once

#include <optional>

#include "spu/volume/observation/deferred_depth.h"
#include "spu/volume/observation/run.h"

namespace understudy::spu {

class FrameAccount;

class RenderSession;

class DepthWatch {
 public:
  DepthWatch(const GlContext& context, RenderSession& session, FrameAccount& account)
      : context_(context), session_(session), account_(account) {}

  /// Called when `run` was substituted. Draws the depth that it writes if it is the `first` of its volume, or
  /// if the depth of an earlier frame was read (`looked_at`). `pixels` is where the depth would be written.
  /// Returns the depth to watch from now on, if any.
  std::optional<DeferredDepth::Watched> settle(const Run& run, const volume::Rect& pixels, bool first,
                                               bool looked_at);

 private:
  const GlContext& context_;
  RenderSession& session_;
  FrameAccount& account_;
};

}  // namespace understudy::spu
