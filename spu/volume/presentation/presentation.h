// SPDX-License-Identifier: Apache-2.0
// The stage that shows a volume: renders its image, checks it, and puts it where the application would have
// drawn.
#pragma once

#include <functional>
#include <optional>

#include "spu/report/optimization.h"
#include "spu/volume/presentation/image_source.h"
#include "spu/volume/presentation/present.h"
#include "spu/volume/presentation/replace.h"
#include "spu/volume/session/render_session.h"
#include "volume/frame_counts.h"

namespace understudy::spu {

class Presentation {
 public:
  /// Receives the image before it is shown unless it is late, and may throw.
  using Check = std::function<void(const volume::ImageView&)>;

  Presentation(const GlContext& context, RenderSession& session, ImageSource& source, FrameAccount& account)
      : session_(session), source_(source), account_(account), presenter_(context), replacer_(context) {}

  /// Renders the request and draws the image into the application's framebuffer. Requires the session's lock.
  /// Throws what `check` and the service throw; then nothing is shown.
  volume::FrameCounts show(compositor::RenderService& service, const ImageToShow& what, const Check& check);
  /// Draws `image`, which the application itself has drawn elsewhere, in place of the request's; alpha, if it
  /// requires a second image, is the service's. Requires the session's lock.
  void show_native(compositor::RenderService& service, const ImageToShow& what, const volume::ImageView& image);

 private:
  bool skips(Optimization optimization) const { return !session_.disabled_optimizations(optimization); }
  void note_shown(const RenderedImage& image);
  void save(const ImageToShow& what, const volume::ImageView& shown);
  void present(compositor::RenderService& service, const ImageToShow& what, RenderedImage& image);

  RenderSession& session_;
  ImageSource& source_;
  FrameAccount& account_;
  Presenter presenter_;
  Replacer replacer_;
  std::uint64_t saved_ = 0;
};

}  // namespace understudy::spu
