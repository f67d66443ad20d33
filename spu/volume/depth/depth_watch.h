// SPDX-License-Identifier: Apache-2.0
// Whether somebody looks at the depth that substituted slices would have written (deferred_depth_write.h).
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

  /// `run` was substituted, the first of its volume or not: draws the depth that it writes where somebody may
  /// look at it, as `looked_at` says of earlier frames. It would be written in `pixels`. Set where its use is
  /// to be watched from now on.
  std::optional<DeferredDepth::Watched> settle(const Run& run, const volume::Rect& pixels, bool first,
                                               bool looked_at);

 private:
  const GlContext& context_;
  RenderSession& session_;
  FrameAccount& account_;
};

}  // namespace understudy::spu
