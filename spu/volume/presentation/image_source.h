// SPDX-License-Identifier: Apache-2.0
// Gets images from the render service, with the application's own samples, or with samples that keep the error
// or the time that was requested.
#pragma once

#include "spu/volume/geometry/polygon.h"
#include "spu/volume/known_volumes/known_volume.h"
#include "spu/volume/pipeline/pipeline.h"
#include "spu/volume/proxy/ray_caster_stage.h"
#include "spu/volume/request/image_request.h"
#include "volume/frame_counts.h"
#include "volume/image.h"

namespace understudy::spu {

class FrameAccount;
class RenderSession;
}  // namespace understudy::spu

namespace understudy::compositor {
class RenderService;
}

namespace understudy::spu {

/// An image that is to be drawn into the framebuffer.
struct RenderedImage {
  volume::ImageView shown;  ///< the service's, valid until its next image; or `kept`
  volume::Image kept;
  volume::FrameCounts counts;

  void keep();
};

/// Describes the image of one volume that is to be shown.
struct ImageToShow {
  const Pipeline& pipeline;
  ImageRequest& image;
  KnownVolume& volume;
  bool compared_whole = false;            ///< compared as a whole before it is shown
  const ObservedPolygons* box = nullptr;  ///< of a ray caster: the polygons that its fragments cover
};

class ImageSource {
 public:
  ImageSource(const GlContext& context, RenderSession& session, RayCasterStage& ray_casters,
              FrameAccount& account)
      : context_(context), session_(session), ray_casters_(ray_casters), account_(account) {}

  /// Renders the samples of the request.
  void cast_own_samples(compositor::RenderService& service, const ImageToShow& what, RenderedImage& image);
  /// Renders with samples that keep the error or the time that was requested; false if the samples must be the
  /// application's own.
  bool cast_within_budget(compositor::RenderService& service, const ImageToShow& what, RenderedImage& image);

 private:
  bool may_be_behind(const ImageToShow& what) const;

  const GlContext& context_;
  RenderSession& session_;
  RayCasterStage& ray_casters_;
  FrameAccount& account_;
};

}  // namespace understudy::spu
