// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/presentation/presentation.h"

#include <fmt/format.h>

#include <cstdio>
#include <string>

#include "compositor/logging/log.h"
#include "compositor/rendered.h"
#include "compositor/service.h"
#include "spu/report/counters.h"
#include "spu/report/optimization.h"
#include "spu/volume/presentation/save_frames.h"
#include "spu/volume/session/render_session.h"
#include "spu/volume/timing/frame_account.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::spu {
namespace {

/// Colours the volume magenta, which proves where the image came from.
void tint(volume::Image& image) {
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const float alpha = image.rgba[i + 3];
    image.rgba[i] = alpha;
    image.rgba[i + 1] = 0;
    image.rgba[i + 2] = alpha;
  }
}

/// Returns what blending leaves of `shown` in the framebuffer's alpha, for a ray caster, whose whole ray is one
/// fragment.
volume::Image alpha_of_fragments(const volume::ImageView& shown, const AlphaBlending& blending) {
  volume::Image alpha(shown.rect);
  for (std::size_t i = 0; i < alpha.rgba.size(); i += 4) {
    const float a = shown.rgba[i + 3];
    alpha.rgba[i] = blending.squared ? a * a : a;
    alpha.rgba[i + 3] = a;
  }
  return alpha;
}

}  // namespace

volume::FrameCounts Presentation::show(compositor::RenderService& service, const ImageToShow& what,
                                       const Check& check) {
  const LiveSettings& settings = session_.settings();
  volume::RenderRequest& request = what.image.request;
  request.optimizations = {skips(Optimization::empty_bricks), skips(Optimization::dominated_samples),
                           skips(Optimization::footprints)};
  if (!skips(Optimization::hidden_samples)) request.termination = 0;
  RenderedImage image;
  if (!settings.has_budget()) ImageSource::end_budget(what.volume);
  const bool own = !settings.has_budget() || what.compared_whole;
  if (own) {
    source_.cast_own_samples(service, what, image);
    // A late image differs from what the application draws now.
    if (!image.late) check(image.shown);
  }
  if (settings.has_budget() && !source_.cast_within_budget(service, what, image) && !own)
    source_.cast_own_samples(service, what, image);
  if (settings.tint || what.pipeline.blending.alpha_stands_apart()) image.keep();
  if (!session_.options().save_frames.empty()) save(what, image.shown);
  if (settings.tint) tint(image.kept);
  const TimedShare timed(account_.clock(), &FrameShares::presentation);
  present(service, what, image);
  note_shown(image);
  return image.counts;
}

void Presentation::show_native(compositor::RenderService& service, const ImageToShow& what,
                               const volume::ImageView& image) {
  const TimedShare timed(account_.clock(), &FrameShares::presentation);
  RenderedImage native{.shown = image, .kept = {}, .counts = {}};
  present(service, what, native);
}

void Presentation::note_shown(const RenderedImage& image) {
  if (!image.view) return;
  session_.windows().shown(*image.view, image.late);
  if (image.late) process_counters().images_behind.fetch_add(1, std::memory_order_relaxed);
}

void Presentation::save(const ImageToShow& what, const volume::ImageView& shown) {
  const std::string trouble = save_frame(session_.options().save_frames, saved_++, what.image.request.viewport,
                                         shown, volume::neutral_value(what.pipeline.blending.op));
  if (!trouble.empty()) logging::log(logging::Level::warn, "{}", trouble);
}

void Presentation::present(compositor::RenderService& service, const ImageToShow& what, RenderedImage& image) {
  const Blending& blending = what.pipeline.blending;
  const Target& target = what.pipeline.target;
  if (what.image.replaces_pixels) return replacer_.replace(image.shown, what.image.no_ray, *what.box);
  if (what.image.covers_samples && what.box != nullptr)
    return replacer_.blend(image.shown, blending.op, !blending.alpha.untouched, *what.box);
  if (!blending.alpha_stands_apart()) return presenter_.present(image.shown, blending, target, nullptr);
  if (what.image.ray_caster) {
    const volume::Image alpha = alpha_of_fragments(image.shown, blending.alpha);
    const volume::ImageView view = alpha.view();
    return presenter_.present(image.shown, blending, target, &view);
  }
  volume::RenderRequest request = what.image.request;
  request.classification = alpha_as_colour(request.classification, blending.alpha);
  request.op = blending.alpha.op;
  request.fog.reset();
  // Less than half a step of the framebuffer's alpha is not visible.
  if (target.alpha_bits <= 8 && skips(Optimization::hidden_samples)) request.termination = 1e-3F;
  const TimedShare also_rendered(account_.clock(), &FrameShares::render);
  const compositor::Rendered alpha = service.render(request);
  image.counts += alpha.counts;
  presenter_.present(image.shown, blending, target, &alpha.image);
}

}  // namespace understudy::spu
