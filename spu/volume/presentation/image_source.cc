// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/presentation/image_source.h"

#include <chrono>

#include "compositor/rendered.h"
#include "compositor/service.h"
#include "spu/report/counters.h"
#include "spu/volume/session/render_session.h"
#include "spu/volume/timing/frame_account.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::spu {

void RenderedImage::keep() {
  kept = copy_of(shown);
  shown = kept.view();
}

bool ImageSource::may_be_behind(const ImageToShow& what) const {
  const Options& options = session_.options();
  if (options.frame_latency == 0 || options.has_budget() || !options.save_frames.empty()) return false;
  // An image that is compared with this frame's request, or shown together with another, must belong to this
  // frame.
  if (what.compared_whole || is_finished_here(what.image, what.volume.march.march) ||
      what.pipeline.blending.alpha_stands_apart())
    return false;
  // The application may keep a framebuffer object, and a late image with it; a window is drawn again.
  GLint framebuffer = 0;
  context_.gl->GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
  return framebuffer == 0;
}

void ImageSource::cast_own_samples(compositor::RenderService& service, const ImageToShow& what,
                                   RenderedImage& image) {
  {
    const TimedShare timed(account_.clock(), &FrameShares::render);
    session_.allow_behind(may_be_behind(what));
    const compositor::Rendered rendered = service.render(what.image.request);
    session_.allow_behind(false);
    session_.note_shown();
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

bool ImageSource::cast_within_budget(compositor::RenderService& service, const ImageToShow& what,
                                     RenderedImage& image) {
  const Options& options = session_.options();
  KnownVolume& volume = what.volume;
  BudgetCounters& counters = volume.counters->budget;
  std::optional<volume::RenderRequest> request;
  {
    const TimedShare timed(account_.clock(), &FrameShares::budget);
    if (!volume.budget)
      volume.budget =
          std::make_unique<Budget>(BudgetAsked{options.error, options.time_ms, options.pixels == "float"});
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
