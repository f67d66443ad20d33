// From a request to the image in the application's framebuffer.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>

#include "spu/volume/presentation/save_frames.h"
#include "spu/volume/proxy/march.h"
#include "spu/volume/substitution.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::spu {
namespace {

/// Magenta wherever the volume is: an image that proves where it came from.
void tint(volume::Image& image) {
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const float alpha = image.rgba[i + 3];
    image.rgba[i] = alpha;
    image.rgba[i + 1] = 0;
    image.rgba[i + 2] = alpha;
  }
}

}  // namespace

/// An image on its way to the framebuffer.
struct VolumeUnit::RenderedImage {
  volume::ImageView shown;  ///< the service's, gone with its next one; or the one that is kept here
  volume::Image kept;
  volume::FrameCounts counts;

  void keep() {
    kept = copy_of(shown);
    shown = kept.view();
  }
};

bool VolumeUnit::is_finished_here(const Substitution& s) {
  return s.proxy && (needs_finish(*s.volume.march) || s.cuts.parts.size() > 1);
}

bool VolumeUnit::may_be_behind(const Substitution& s) {
  const Options& options = session_->options();
  if (options.frame_latency == 0 || options.has_budget() || !options.save_frames.empty()) return false;
  // What is compared with this frame's request, or shown together with another image, belongs to this frame.
  if (to_be_verified(s) || is_finished_here(s) || s.pipeline.blending.alpha_stands_apart()) return false;
  // Framebuffer objects may be kept, and no window shows them again.
  GLint framebuffer = 0;
  context().gl->GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
  return framebuffer == 0;
}

void VolumeUnit::cast_own_samples(compositor::RenderService& service, Substitution& s, RenderedImage& image) {
  {
    const TimedShare timed(clock_, &FrameShares::render);
    session_->allow_behind(may_be_behind(s));
    const compositor::Rendered rendered = service.render(s.request);
    session_->allow_behind(false);
    session_->note_shown();
    image.shown = rendered.image;
    image.counts += rendered.counts;
  }
  if (is_finished_here(s)) {
    const TimedShare timed(clock_, &FrameShares::presentation);
    image.keep();
    complete_image(s, service, *s.volume.march, image.kept, image.counts);
    image.shown = image.kept.view();
  }
  if (s.proxy) s.request.depth = s.opaque;
}

bool VolumeUnit::cast_within_budget(compositor::RenderService& service, Substitution& s, RenderedImage& image) {
  const Options& options = session_->options();
  BudgetCounters& counters = s.volume.counters->budget;
  std::optional<volume::RenderRequest> request;
  {
    const TimedShare timed(clock_, &FrameShares::budget);
    if (!s.volume.budget)
      s.volume.budget =
          std::make_unique<Budget>(BudgetAsked{options.error, options.time_ms, options.pixels == "float"});
    const std::string obstacle = is_finished_here(s)   ? "what rays find is shown by the ray caster's own rules"
                                 : !s.ray_ends.empty() ? "planes cut the ray caster's box"
                                                       : "";
    request = s.volume.budget->request(service, s.request, obstacle, s.volume.description,
                                       session_->generation(), counters);
  }
  if (!request) return false;
  const auto start = std::chrono::steady_clock::now();
  bool repeated = false;
  {
    const TimedShare timed(clock_, &FrameShares::render);
    const compositor::Rendered rendered = service.render(*request);
    image.shown = rendered.image;
    image.counts += rendered.counts;
    repeated = rendered.repeated;
  }
  note([](FrameRecord& frame) { ++frame.within_budget; });
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  const TimedShare timed(clock_, &FrameShares::budget);
  s.volume.budget->look_at(service, image.shown, repeated ? std::nullopt : std::optional(took.count()),
                           counters);
  return true;
}

volume::FrameCounts VolumeUnit::show(compositor::RenderService& service, Substitution& s,
                                     const std::function<void(const volume::ImageView&)>& check) {
  const Options& options = session_->options();
  const Blending& blending = s.pipeline.blending;
  const auto left_out = [&](Optimization optimization) {
    return !session_->disabled_optimizations(optimization);
  };
  s.request.optimizations = {left_out(Optimization::empty_bricks), left_out(Optimization::dominated_samples),
                             left_out(Optimization::footprints)};
  if (!left_out(Optimization::hidden_samples)) s.request.termination = 0;
  RenderedImage image;
  const bool own = !options.has_budget() || to_be_verified(s);
  if (own) {
    cast_own_samples(service, s, image);
    check(image.shown);
  }
  if (options.has_budget() && !cast_within_budget(service, s, image) && !own)
    cast_own_samples(service, s, image);
  if (options.debug_tint || blending.alpha_stands_apart()) image.keep();
  const volume::ImageView shown = image.shown;
  if (!options.save_frames.empty()) {
    const std::string trouble = save_frame(options.save_frames, saved_++, s.request.viewport, shown,
                                           volume::neutral_value(blending.op));
    if (!trouble.empty()) fmt::print(stderr, "understudy: {}\n", trouble);
  }
  if (options.debug_tint) tint(image.kept);
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
    if (s.pipeline.target.alpha_bits <= 8 && left_out(Optimization::hidden_samples))
      request.termination = 1e-3F;
    const TimedShare also_rendered(clock_, &FrameShares::render);
    const compositor::Rendered alpha = service.render(request);
    image.counts += alpha.counts;
    presenter_->present(shown, blending, s.pipeline.target, &alpha.image);
  } else {
    presenter_->present(shown, blending, s.pipeline.target, nullptr);
  }
  return image.counts;
}

}  // namespace understudy::spu
