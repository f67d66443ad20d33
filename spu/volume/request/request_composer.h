// SPDX-License-Identifier: Apache-2.0
// The stage that composes a request: camera, samples, colours, window, and what hides the volume.
#pragma once

#include "spu/volume/geometry/fit.h"
#include "spu/volume/pipeline/pipeline.h"
#include "volume/request.h"

namespace understudy::spu {

class FrameAccount;

class RenderSession;

struct GlContext;

class RequestComposer {
 public:
  RequestComposer(const GlContext& context, RenderSession& session, FrameAccount& account)
      : context_(context), session_(session), account_(account) {}

  /// Returns a request for the part `region` of `volume`, as `pipeline` draws it into the context's viewport;
  /// the caller fills in samples and colours.
  volume::RenderRequest compose(const Pipeline& pipeline, const CameraFit& camera, const volume::Box& region,
                                const volume::VolumeDescription& volume, volume::Filter filter) const;

  /// Adds the depth of the application's opaque geometry if the pipeline tests depth.
  void hide_behind_geometry(const Pipeline& pipeline, volume::RenderRequest& request);

 private:
  const GlContext& context_;
  RenderSession& session_;
  FrameAccount& account_;
};

}  // namespace understudy::spu
