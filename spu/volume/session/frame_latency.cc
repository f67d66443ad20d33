// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/session/frame_latency.h"

#include <unistd.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "compositor/rendered.h"
#include "compositor/service/blocked_signals.h"

namespace understudy::spu {
namespace {

using volume::RenderRequest;

constexpr std::size_t most_images = 8;

/// Also by what moves with the camera: where samples lie.
bool differ_by_the_camera_alone(const RenderRequest& a, const RenderRequest& b) {
  RenderRequest as_b = a;
  as_b.texture_to_clip = b.texture_to_clip;
  as_b.planes = b.planes;
  as_b.steps = b.steps;
  as_b.region = b.region;
  as_b.slice_segment = b.slice_segment;
  as_b.fog = b.fog;
  as_b.light = b.light;
  as_b.exact = b.exact;
  return a.steps.has_value() == b.steps.has_value() && as_b == b;
}

/// Whether both requests are for the same image, exact or not.
bool are_for_one_image(const RenderRequest& a, RenderRequest b) {
  b.exact = a.exact;
  return a == b;
}

double distance_square(const volume::Matrix4& a, const volume::Matrix4& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

/// Whether `now` is nearer to the camera before the last one: a program may show the eyes of a stereo image in
/// alternate frames.
bool goes_to_and_fro(const volume::Matrix4& now, const volume::Matrix4& last, const volume::Matrix4& before) {
  return distance_square(now, before) < distance_square(now, last);
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

/// Keeps the image that is being cast. Throws ServiceLost if it was lost. A view whose image was refused has
/// none: its next request is answered, or refused, for itself.
void FrameLatency::finish() {
  if (!cast_.valid()) return;
  if (getpid() != process_) {
    // After a fork() the casting thread exists in the parent only: waiting for it would never end.
    static_cast<void>(new std::future<ViewImage>(std::move(cast_)));
    return;
  }
  try {
    keep(cast_.get());
  } catch (const compositor::ServiceLost&) {
    throw;
  } catch (const std::exception&) {
    // Whatever is done now may belong to another volume, which must not be refused for it.
  }
}

void FrameLatency::keep(ViewImage latest) {
  std::erase_if(images_, [&](const ViewImage& each) { return each.where.view == latest.where.view; });
  if (images_.size() == most_images) images_.erase(images_.begin());
  images_.push_back(std::move(latest));
}

void FrameLatency::forget_images(volume::VolumeId id) {
  finish();
  std::erase_if(images_, [&](const ViewImage& each) { return each.request.volume == id; });
}

FrameLatency::ViewImage* FrameLatency::image_of(const View& view) {
  const auto found =
      std::ranges::find_if(images_, [&](const ViewImage& each) { return each.where.view == view; });
  return found == images_.end() ? nullptr : &*found;
}

/// Geometry in front of a volume may move otherwise than the camera: an image that it hides is never late.
const FrameLatency::ViewImage* FrameLatency::previous(const ViewInFrame& where, const RenderRequest& request) {
  const ViewImage* const last = image_of(where.view);
  if (last == nullptr || last->where.frame + 1 != where.frame) return nullptr;
  if (must_be_exact(request) || request.depth || last->request.depth) return nullptr;
  if (!differ_by_the_camera_alone(last->request, request)) return nullptr;
  const volume::Matrix4& camera = last->request.texture_to_clip;
  if (last->camera_before && goes_to_and_fro(request.texture_to_clip, camera, *last->camera_before))
    return nullptr;
  return last;
}

void FrameLatency::begin_volume(const volume::VolumeDescription& volume) {
  forget_images(volume.id);
  service_->begin_volume(volume);
}

void FrameLatency::begin_change(volume::VolumeId id, std::uint64_t version) {
  forget_images(id);
  service_->begin_change(id, version);
}

void FrameLatency::add_texels(volume::VolumeId id, std::span<const volume::TexelBox> boxes,
                              std::span<const std::byte> texels) {
  forget_images(id);
  service_->add_texels(id, boxes, texels);
}

void FrameLatency::end_volume(volume::VolumeId id) {
  forget_images(id);
  service_->end_volume(id);
}

void FrameLatency::forget_volume(volume::VolumeId id) {
  forget_images(id);
  service_->forget_volume(id);
}

compositor::Rendered FrameLatency::render(const RenderRequest& request) {
  finish();
  return service_->render(request);
}

std::optional<volume::Rect> FrameLatency::late_image(const ViewInFrame& where, const RenderRequest& request) {
  finish();
  const ViewImage* const last = previous(where, request);
  if (last == nullptr || are_for_one_image(last->request, request)) return std::nullopt;
  return last->image.rect;
}

compositor::Rendered FrameLatency::render_view(const ViewInFrame& where, const RenderRequest& request,
                                               bool may_be_late) {
  late_ = false;
  if (may_be_late && late_image(where, request)) return answer_late(where, request);
  finish();
  ViewImage* const last = image_of(where.view);
  const bool same = last != nullptr && are_for_one_image(last->request, request);
  // Nodes may have rounded an image that was not to be exact (--pixels).
  if (same && !last->lossy && (last->exact || !request.exact)) {
    last->where.frame = where.frame;
    last->camera_before = request.texture_to_clip;
    const bool repeated = std::exchange(last->told, true);
    return {last->image.view(), repeated ? volume::FrameCounts() : last->counts, repeated};
  }
  std::optional<volume::Matrix4> camera_before;
  if (last != nullptr) camera_before = last->request.texture_to_clip;
  compositor::Rendered rendered = service_->render(same ? volume::exactly(request) : request);
  keep({where, request, camera_before, copy_of(rendered.image), rendered.counts, true, rendered.lossy,
        request.exact || same});
  return rendered;
}

compositor::Rendered FrameLatency::answer_late(const ViewInFrame& where, const RenderRequest& request) {
  ViewImage& last = *image_of(where.view);
  const volume::FrameCounts counts = last.told ? volume::FrameCounts() : last.counts;
  const volume::Matrix4 camera_before = last.request.texture_to_clip;
  shown_ = std::move(last.image);
  images_.erase(images_.begin() + (&last - images_.data()));
  const compositor::BlockedSignals blocked;
  cast_ = std::async(std::launch::async, [this, where, request, camera_before] {
    const compositor::Rendered rendered = service_->render(request);
    return ViewImage{where,           request, camera_before,  copy_of(rendered.image),
                     rendered.counts, false,   rendered.lossy, request.exact};
  });
  late_ = true;
  return {shown_.view(), counts, false};
}

std::vector<volume::PixelIntegral> FrameLatency::integrals(const RenderRequest& request,
                                                           std::span<const volume::Pixel> pixels,
                                                           double most_ms) {
  finish();
  return service_->integrals(request, pixels, most_ms);
}

}  // namespace understudy::spu
