// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/presentation/image_source.h"

#include <chrono>

#include "compositor/rendered.h"
#include "compositor/service.h"
#include "spu/report/counters.h"
#include "spu/volume/depth/depth.h"
#include "spu/volume/session/frame_latency.h"
#include "spu/volume/session/render_session.h"
#include "spu/volume/timing/frame_account.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::spu {

void RenderedImage::keep() {
  kept = copy_of(shown);
  shown = kept.view();
}

bool ImageSource::may_be_late(const ImageToShow& what, const View& view) const {
  const Options& options = session_.options();
  if (session_.settings().has_budget() || !options.save_frames.empty()) return false;
  // What is shown together with another image, drawn with this frame's box, or hides what is drawn later by
  // this frame's depth, must be of this frame.
  if (is_finished_here(what.image, what.volume.march.march) || what.pipeline.blending.alpha_stands_apart() ||
      what.image.replaces_pixels || (what.image.covers_samples && what.box != nullptr) ||
      what.volume.depth_looked_at)
    return false;
  // The application may keep a framebuffer object, and a late image with it; a window is drawn again.
  return view.framebuffer == 0 && session_.windows().can_be_redrawn(view.window);
}

/// The depth was read where the volume is in this frame; the image of the frame before may cover more.
bool ImageSource::is_hidden_by_nothing(const ImageToShow& what, const volume::Rect& rect) const {
  if (!what.pipeline.depth_test) return true;
  const TimedShare timed(account_.clock(), &FrameShares::depth);
  const auto depth = read_depth(context_, what.pipeline.target, rect, what.pipeline.depth_or_equal);
  return !depth || hides_nothing(*depth);
}

compositor::Rendered ImageSource::rendered(compositor::RenderService& service, const ImageToShow& what,
                                           RenderedImage& image) const {
  const volume::RenderRequest& request = what.image.request;
  FrameLatency* const latency = session_.frame_latency(service);
  if (latency == nullptr) return service.render(request);
  const View view = current_view(context_, what.texture, views_.window());
  image.view = view;
  if (!may_be_late(what, view)) return service.render(request);
  const ViewInFrame where{view, session_.windows().frame(view.window)};
  const auto previous =
      views_.stands_alone(view, where.frame) ? latency->late_image(where, request) : std::nullopt;
  const compositor::Rendered rendered =
      latency->render_view(where, request, previous && is_hidden_by_nothing(what, *previous));
  image.late = latency->is_late();
  return rendered;
}

void ImageSource::cast_own_samples(compositor::RenderService& service, const ImageToShow& what,
                                   RenderedImage& image) {
  {
    const TimedShare timed(account_.clock(), &FrameShares::render);
    const compositor::Rendered rendered = this->rendered(service, what, image);
    image.shown = rendered.image;
    image.counts += rendered.counts;
  }
  if (is_finished_here(what.image, what.volume.march.march)) {
    const TimedShare timed(account_.clock(), &FrameShares::presentation);
    image.keep();
    ray_casters_.complete_image(*what.volume.march.march, what.image, service, image.kept, image.counts);
    image.shown = image.kept.view();
  }
  if (what.image.ray_caster) what.image.request.depth = what.image.opaque;
}

void ImageSource::end_budget(KnownVolume& volume) {
  if (!volume.budget) return;
  volume.budget.reset();
  volume.counters->budget = {};
}

bool ImageSource::cast_within_budget(compositor::RenderService& service, const ImageToShow& what,
                                     RenderedImage& image) {
  const LiveSettings& settings = session_.settings();
  KnownVolume& volume = what.volume;
  BudgetCounters& counters = volume.counters->budget;
  std::optional<volume::RenderRequest> request;
  {
    const TimedShare timed(account_.clock(), &FrameShares::budget);
    const BudgetAsked asked{settings.error, settings.time_ms, session_.options().pixels == "float"};
    if (!volume.budget || volume.budget->asked() != asked) volume.budget = std::make_unique<Budget>(asked);
    const std::string obstacle = is_finished_here(what.image, volume.march.march)
                                     ? "what rays find is shown by the ray caster's own rules"
                                 : !what.image.ray_ends.empty() ? "planes cut the ray caster's box"
                                                                : "";
    request = volume.budget->request(service, what.image.request, obstacle, volume.sent.description,
                                     session_.generation(), counters);
  }
  if (!request) return false;
  const auto start = std::chrono::steady_clock::now();
  bool repeated = false;
  {
    const TimedShare timed(account_.clock(), &FrameShares::render);
    const compositor::Rendered rendered = service.render(*request);
    image.shown = rendered.image;
    image.counts += rendered.counts;
    repeated = rendered.repeated;
  }
  account_.note([](FrameRecord& frame) { ++frame.within_budget; });
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  const TimedShare timed(account_.clock(), &FrameShares::budget);
  volume.budget->look_at(service, image.shown, repeated ? std::nullopt : std::optional(took.count()), counters);
  return true;
}

}  // namespace understudy::spu
