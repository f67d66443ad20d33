// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/request/request_composer.h"

#include "spu/report/optimization.h"
#include "spu/volume/context/context.h"
#include "spu/volume/depth/depth.h"
#include "spu/volume/session/render_session.h"
#include "spu/volume/timing/frame_account.h"
#include "volume/footprint.h"

namespace understudy::spu {

volume::RenderRequest RequestComposer::compose(const Pipeline& pipeline, const CameraFit& camera,
                                               const volume::Box& region,
                                               const volume::VolumeDescription& volume,
                                               volume::Filter filter) const {
  const DispatchTable& gl = *context_.gl;
  volume::RenderRequest request;
  std::array<GLint, 4> viewport{};
  gl.GetIntegerv(GL_VIEWPORT, viewport.data());
  request.viewport = {viewport[0], viewport[1], viewport[2], viewport[3]};
  request.window = request.viewport;
  if (gl.IsEnabled(GL_SCISSOR_TEST)) {
    std::array<GLint, 4> scissor{};
    gl.GetIntegerv(GL_SCISSOR_BOX, scissor.data());
    request.window = intersection(request.window, {scissor[0], scissor[1], scissor[2], scissor[3]});
  }
  gl.GetDoublev(GL_DEPTH_RANGE, request.depth_range.data());
  request.volume = volume.id;
  request.version = volume.version;
  request.texture_to_clip = camera.texture_to_clip;
  request.region = region;
  request.op = pipeline.blending.op;
  request.filter = filter;
  return request;
}

void RequestComposer::hide_behind_geometry(const Pipeline& pipeline, volume::RenderRequest& request) {
  if (!pipeline.depth_test) return;
  const TimedShare timed(account_.clock(), &FrameShares::depth);
  request.depth = read_depth(context_, pipeline.target, volume::footprint(request, request.region),
                             pipeline.depth_or_equal);
  if (!request.depth) return;
  // If there is no opaque geometry, no depth is sent.
  const std::uint64_t bytes = sizeof(float) * request.depth->depth.size();
  const bool absent =
      hides_nothing(*request.depth) && !session_.disabled_optimizations(Optimization::absent_depth);
  if (absent) request.depth.reset();
  account_.note([&](FrameRecord& frame) {
    Amount& depth = frame.amount(Optimization::absent_depth);
    (absent ? depth.left_out : depth.done) += bytes;
  });
  if (!absent) count_done(Optimization::absent_depth, "opaque geometry stands in the image");
}

}  // namespace understudy::spu
