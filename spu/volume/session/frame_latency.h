// SPDX-License-Identifier: Apache-2.0
// A render service in front of another one that lets the nodes work while the application does
// (`--frame-latency 1`). While the camera moves, a request is answered with the image of the previous one, and
// its own image is cast until the next request comes. A repeated request is answered with its own image, so
// that a camera at rest never shows a late one, nor a lossy one.
#pragma once

#include <sys/types.h>

#include <future>
#include <memory>
#include <vector>

#include "compositor/service.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::spu {

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

  /// Sets whether the images of the next requests may be late; initially they may not.
  void allow(bool behind) { allowed_ = behind; }
  /// Whether the latest image is that of an earlier request.
  bool is_behind() const { return behind_; }

  compositor::Rendered render(const volume::RenderRequest& request) override;
  std::vector<volume::PixelIntegral> integrals(const volume::RenderRequest& request,
                                               std::span<const volume::Pixel> pixels, double most_ms) override;
  int nodes() const override { return service_->nodes(); }

 private:
  /// The latest image of requests that differ by the camera alone.
  struct View {
    volume::RenderRequest request;
    volume::Image image;
    volume::FrameCounts counts;
    bool told = false;   ///< the counts have been returned
    bool lossy = false;  ///< not to be shown again
    bool exact = false;  ///< as it was cast
  };

  void finish();
  void keep(View latest);
  void forget_views();
  View* view_like(const volume::RenderRequest& request);

  std::unique_ptr<compositor::RenderService> service_;
  pid_t process_;
  bool allowed_ = false;
  bool behind_ = false;
  std::vector<View> views_;  ///< the latest last
  volume::Image shown_;      ///< the late image that was returned
  std::future<View> cast_;
};

}  // namespace understudy::spu
