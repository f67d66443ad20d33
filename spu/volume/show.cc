// From a request to the picture in the application's framebuffer.
#include <fmt/format.h>

#include <cstdio>

#include "spu/volume/proxy/march.h"
#include "spu/volume/save_frames.h"
#include "spu/volume/substitution.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::spu {
namespace {

/// Magenta wherever the volume is: a picture that proves where it came from.
void tint(volume::Image& picture) {
  for (std::size_t i = 0; i < picture.rgba.size(); i += 4) {
    const float alpha = picture.rgba[i + 3];
    picture.rgba[i] = alpha;
    picture.rgba[i + 1] = 0;
    picture.rgba[i + 2] = alpha;
  }
}

}  // namespace

volume::FrameCounts VolumeUnit::show(compositor::RenderService& service, Substitution& s,
                                     const std::function<void(const volume::ImageView&)>& check) {
  const Options& options = session_->options();
  const auto render = [&](const volume::RenderRequest& request) {
    const TimedShare timed(clock_, &FrameShares::render);
    return service.render(request);
  };
  const compositor::Rendered rendered = render(s.request);

  // The service's picture is gone with its next answer.
  const Blending& blending = s.pipeline.blending;
  volume::Image picture;
  volume::ImageView shown = rendered.image;
  volume::FrameCounts counts = rendered.counts;
  const bool finished_here = s.proxy && (needs_finish(*s.volume.march) || s.cuts.parts.size() > 1);
  if (options.debug_tint || blending.alpha_stands_apart() || finished_here) {
    const TimedShare timed(clock_, &FrameShares::presentation);
    picture.rect = shown.rect;
    picture.rgba.assign(shown.rgba.begin(), shown.rgba.end());
    shown = picture.view();
  }
  if (finished_here) {
    const TimedShare timed(clock_, &FrameShares::presentation);
    complete_picture(s, service, *s.volume.march, picture, counts);
    shown = picture.view();
  }
  if (s.proxy) s.request.depth = s.opaque;
  check(shown);
  if (!options.save_frames.empty()) {
    const std::string trouble = save_frame(options.save_frames, saved_++, s.request.viewport, shown,
                                           volume::neutral_value(blending.op));
    if (!trouble.empty()) fmt::print(stderr, "understudy: {}\n", trouble);
  }
  if (options.debug_tint) tint(picture);
  const TimedShare timed(clock_, &FrameShares::presentation);
  if (!presenter_) presenter_ = std::make_unique<Presenter>(context());
  if (blending.alpha_stands_apart() && s.proxy) {
    // The whole ray is one fragment.
    volume::Image alpha(shown.rect);
    for (std::size_t i = 0; i < alpha.rgba.size(); i += 4) {
      const float a = shown.rgba[i + 3];
      alpha.rgba[i] = blending.alpha.squared ? a * a : a;
      alpha.rgba[i + 3] = a;
    }
    const volume::ImageView view = alpha.view();
    presenter_->present(shown, blending, s.pipeline.target, &view);
  } else if (blending.alpha_stands_apart()) {
    volume::RenderRequest request = s.request;
    request.classification = alpha_as_colour(s.request.classification, blending.alpha);
    request.op = blending.alpha.op;
    request.fog.reset();
    // Below half a step of what the framebuffer keeps of alpha, nothing is left to see.
    if (s.pipeline.target.alpha_bits <= 8) request.termination = 1e-3F;
    const compositor::Rendered alpha = render(request);
    counts += alpha.counts;
    presenter_->present(shown, blending, s.pipeline.target, &alpha.image);
  } else {
    presenter_->present(shown, blending, s.pipeline.target, nullptr);
  }
  return counts;
}

}  // namespace understudy::spu
