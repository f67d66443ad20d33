// SPDX-License-Identifier: Apache-2.0
// Gets images from the render service, with the application's own samples, or with samples that keep the error
// or the time that was requested.
#pragma once

#include <optional>

#include "spu/volume/geometry/polygon.h"
#include "spu/volume/known_volumes/known_volume.h"
#include "spu/volume/pipeline/pipeline.h"
#include "spu/volume/proxy/ray_caster_stage.h"
#include "spu/volume/request/image_request.h"
#include "spu/volume/views/drawn_views.h"
#include "volume/frame_counts.h"
#include "volume/image.h"

namespace understudy::spu {

class FrameAccount;
class RenderSession;
}  // namespace understudy::spu

namespace understudy::compositor {
class RenderService;
struct Rendered;
}  // namespace understudy::compositor

namespace understudy::spu {

/// An image that is to be drawn into the framebuffer.
struct RenderedImage {
  volume::ImageView shown;  ///< the service's, valid until its next image; or `kept`
  volume::Image kept;
  volume::FrameCounts counts;
  std::optional<View> view;  ///< it is shown in, if images may be late
  bool late = false;         ///< it is that of the frame before

  void keep();
};

/// Describes the image of one volume that is to be shown.
struct ImageToShow {
  const Pipeline& pipeline;
  ImageRequest& image;
  KnownVolume& volume;
  GLuint texture = 0;                     ///< by which the volume is known
  bool compared_whole = false;            ///< compared as a whole before it is shown
  const ObservedPolygons* box = nullptr;  ///< of a ray caster: the polygons that its fragments cover
};

class ImageSource {
 public:
  ImageSource(const GlContext& context, RenderSession& session, const DrawnViews& views,
              RayCasterStage& ray_casters, FrameAccount& account)
      : context_(context), session_(session), views_(views), ray_casters_(ray_casters), account_(account) {}

  /// Renders the samples of the request.
  void cast_own_samples(compositor::RenderService& service, const ImageToShow& what, RenderedImage& image);
  /// Renders with samples that keep the error or the time that was requested; false if the samples must be the
  /// application's own.
  bool cast_within_budget(compositor::RenderService& service, const ImageToShow& what, RenderedImage& image);
  /// Called when no error and no time is requested any more.
  static void end_budget(KnownVolume& volume);

 private:
  compositor::Rendered rendered(compositor::RenderService& service, const ImageToShow& what,
                                RenderedImage& image) const;
  bool may_be_late(const ImageToShow& what, const View& view) const;
  bool is_hidden_by_nothing(const ImageToShow& what, const volume::Rect& rect) const;

  const GlContext& context_;
  RenderSession& session_;
  const DrawnViews& views_;
  RayCasterStage& ray_casters_;
  FrameAccount& account_;
};

}  // namespace understudy::spu
