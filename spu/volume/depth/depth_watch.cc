// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/depth/depth_watch.h"

#include <string_view>

#include "spu/report/optimization.h"
#include "spu/volume/context/context.h"
#include "spu/volume/depth/deferred_depth_write.h"
#include "spu/volume/session/render_session.h"
#include "spu/volume/timing/frame_account.h"

namespace understudy::spu {

bool DepthWatch::settle(const Run& run, bool first, bool looked_at) {
  if (!run.pipeline().depth_test || !run.pipeline().depth_write) return false;
  const std::string_view why = first       ? "the first of the volume"
                               : looked_at ? "somebody looked at it"
                               : session_.disabled_optimizations(Optimization::unseen_depth) ? "asked to"
                                                                                             : "";
  // First what is seen: what is counted may fail.
  if (!why.empty()) write_depth(*context_.gl, run);
  account_.note([&](FrameRecord& frame) {
    Amount& runs = frame.amount(Optimization::unseen_depth);
    ++(why.empty() ? runs.left_out : runs.done);
  });
  if (!why.empty()) count_done(Optimization::unseen_depth, why);
  return !looked_at;
}

}  // namespace understudy::spu
