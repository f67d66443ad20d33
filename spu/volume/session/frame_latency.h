// SPDX-License-Identifier: Apache-2.0
// A render service in front of another one that lets the nodes work while the application does
// (`--frame-latency 1`). While the camera moves, a view's request is answered with the image of its request in
// the frame before, and its own image is cast until the next request comes. A repeated request is answered with
// its own image, so that a camera at rest never shows a late one, nor a lossy one.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "compositor/service.h"
#include "spu/volume/views/view.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::spu {

/// A view in one frame of its window.
struct ViewInFrame {
  View view;
  std::uint64_t frame = 0;
};

class FrameLatency final : public compositor::RenderService {
 public:
  explicit FrameLatency(std::unique_ptr<compositor::RenderService> service);
  ~FrameLatency() override;

  void begin_volume(const volume::VolumeDescription& volume) override;
  void begin_change(volume::VolumeId id, std::uint64_t version) override;
  void add_texels(volume::VolumeId id, std::span<const volume::TexelBox> boxes,
                  std::span<const std::byte> texels) override;
  void end_volume(volume::VolumeId id) override;
  void forget_volume(volume::VolumeId id) override;

  /// Answers with the request's own image.
  compositor::Rendered render(const volume::RenderRequest& request) override;
  std::vector<volume::PixelIntegral> integrals(const volume::RenderRequest& request,
                                               std::span<const volume::Pixel> pixels, double most_ms) override;
  int nodes() const override { return service_->nodes(); }

  /// Returns where the image lies that answers the request if it may be late; null if there is none of the
  /// frame before that may be shown: it was requested with other colours, the request must be exact, or the
  /// camera goes to and fro.
  std::optional<volume::Rect> late_image(const ViewInFrame& where, const volume::RenderRequest& request);
  /// Answers with an image for the view: that of late_image() if `may_be_late`, otherwise the request's own.
  compositor::Rendered render_view(const ViewInFrame& where, const volume::RenderRequest& request,
                                   bool may_be_late);
  /// Whether the image of the latest render_view() is that of the frame before.
  bool is_late() const { return late_; }

 private:
  /// The latest image of a view.
  struct ViewImage {
    ViewInFrame where;
    volume::RenderRequest request;
    std::optional<volume::Matrix4> camera_before;  ///< of the view's request before this one
    volume::Image image;
    volume::FrameCounts counts;
    bool told = false;   ///< the counts have been returned
    bool lossy = false;  ///< not to be shown again
    bool exact = false;  ///< as it was cast
  };

  void finish();
  void keep(ViewImage latest);
  void forget_images(volume::VolumeId id);
  ViewImage* image_of(const View& view);
  const ViewImage* previous(const ViewInFrame& where, const volume::RenderRequest& request);
  compositor::Rendered answer_late(const ViewInFrame& where, const volume::RenderRequest& request);

  std::unique_ptr<compositor::RenderService> service_;
  pid_t process_;
  bool late_ = false;
  std::vector<ViewImage> images_;  ///< the latest last
  volume::Image shown_;            ///< the late image that was returned
  std::future<ViewImage> cast_;
};

}  // namespace understudy::spu
