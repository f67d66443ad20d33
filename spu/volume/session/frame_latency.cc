// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/session/frame_latency.h"

#include <unistd.h>

#include <algorithm>
#include <utility>

#include "compositor/rendered.h"
#include "compositor/service/blocked_signals.h"

namespace understudy::spu {
namespace {

using volume::RenderRequest;

constexpr std::size_t most_views = 4;

/// Also by what moves with the camera: where samples lie, the opaque geometry in front, and whether the image
/// is compared.
bool differ_by_the_camera_alone(const RenderRequest& a, const RenderRequest& b) {
  RenderRequest as_b = a;
  as_b.texture_to_clip = b.texture_to_clip;
  as_b.planes = b.planes;
  as_b.steps = b.steps;
  as_b.region = b.region;
  as_b.slice_segment = b.slice_segment;
  as_b.fog = b.fog;
  as_b.light = b.light;
  as_b.depth = b.depth;
  as_b.exact = b.exact;
  return a.steps.has_value() == b.steps.has_value() && a.depth.has_value() == b.depth.has_value() && as_b == b;
}

}  // namespace

FrameLatency::FrameLatency(std::unique_ptr<compositor::RenderService> service)
    : service_(std::move(service)), process_(getpid()) {}

FrameLatency::~FrameLatency() {
  try {
    finish();
  } catch (...) {
    // There is nobody to report to.
  }
}

/// Makes a view of the image that is being cast. Throws what casting it threw.
void FrameLatency::finish() {
  if (!cast_.valid()) return;
  if (getpid() != process_) {
    // After a fork() the casting thread exists in the parent only: waiting for it would never end.
    static_cast<void>(new std::future<View>(std::move(cast_)));
    return;
  }
  keep(cast_.get());
}

void FrameLatency::keep(View latest) {
  std::erase_if(views_,
                [&](const View& view) { return differ_by_the_camera_alone(view.request, latest.request); });
  if (views_.size() == most_views) views_.erase(views_.begin());
  views_.push_back(std::move(latest));
}

void FrameLatency::forget_views() {
  finish();
  views_.clear();
}

FrameLatency::View* FrameLatency::view_like(const RenderRequest& request) {
  const auto found = std::ranges::find_if(
      views_, [&](const View& view) { return differ_by_the_camera_alone(view.request, request); });
  return found == views_.end() ? nullptr : &*found;
}

void FrameLatency::begin_volume(const volume::VolumeDescription& volume) {
  forget_views();
  service_->begin_volume(volume);
}

void FrameLatency::begin_change(volume::VolumeId id, std::uint64_t version) {
  forget_views();
  service_->begin_change(id, version);
}

void FrameLatency::add_texels(volume::VolumeId id, std::span<const volume::TexelBox> boxes,
                              std::span<const std::byte> texels) {
  forget_views();
  service_->add_texels(id, boxes, texels);
}

void FrameLatency::end_volume(volume::VolumeId id) {
  forget_views();
  service_->end_volume(id);
}

void FrameLatency::forget_volume(volume::VolumeId id) {
  forget_views();
  service_->forget_volume(id);
}

compositor::Rendered FrameLatency::render(const RenderRequest& request) {
  behind_ = false;
  finish();
  View* const view = view_like(request);
  // Nodes may have rounded an image that was not to be exact (--pixels).
  const bool lossy = view != nullptr && (view->lossy || (request.exact && !view->exact));
  if (view != nullptr) view->request.exact = request.exact;
  const bool same = view != nullptr && view->request == request;
  if (same && !lossy) {
    const bool repeated = std::exchange(view->told, true);
    return {view->image.view(), repeated ? volume::FrameCounts() : view->counts, repeated};
  }
  if (!allowed_ || view == nullptr || same) {
    compositor::Rendered rendered = service_->render(same ? volume::exactly(request) : request);
    // Also where it may not be late: the next image that may would be an earlier one.
    if (allowed_ || view != nullptr)
      keep({request, copy_of(rendered.image), rendered.counts, true, rendered.lossy, request.exact || same});
    return rendered;
  }
  const volume::FrameCounts counts = view->told ? volume::FrameCounts() : view->counts;
  shown_ = std::move(view->image);
  views_.erase(views_.begin() + (view - views_.data()));
  const compositor::BlockedSignals blocked;
  cast_ = std::async(std::launch::async, [this, request] {
    const compositor::Rendered rendered = service_->render(request);
    return View{request, copy_of(rendered.image), rendered.counts, false, rendered.lossy, request.exact};
  });
  behind_ = true;
  return {shown_.view(), counts, false};
}

std::vector<volume::PixelIntegral> FrameLatency::integrals(const RenderRequest& request,
                                                           std::span<const volume::Pixel> pixels,
                                                           double most_ms) {
  finish();
  return service_->integrals(request, pixels, most_ms);
}

}  // namespace understudy::spu
