// SPDX-License-Identifier: Apache-2.0
// The volume that viewers look at, behind a service that may be lost and made again.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "apps/understudy/cli/loading_nodes.h"
#include "apps/understudy/file_scene/file_scene.h"
#include "apps/understudy/view/image_encoding.h"
#include "apps/understudy/view/view_state.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::launcher {

class ShownVolume {
 public:
  ShownVolume(const FileScene& scene, ServiceMaker make) : scene_(scene), make_(std::move(make)) {}

  const FileScene& scene() const { return scene_; }

  /// Makes a service, and has it read the volume; `progress` hears after every step how far the ranks are.
  /// Throws ServiceLost and RequestRefused.
  void load(const std::function<void(const std::vector<compositor::RankLoad>&)>& progress);

  // From here on the volume is loaded. What is lost throws ServiceLost; then load() again.

  struct Drawn {
    RgbImage image;
    volume::RenderRequest request;
    volume::FrameCounts counts;
    double ms = 0;  ///< to render and to composite, as it was waited for
  };
  Drawn draw(const ViewState& state);

  struct Exactness {
    double error = 0;  ///< greatest difference of a channel from the integral, of the rays that were looked at
    std::size_t rays = 0;
  };
  /// Of the image drawn last, each time of other rays; nothing where what it shows has no integral (surfaces,
  /// light, other operators).
  std::optional<Exactness> exactness();

  /// What each rank has, and what its part of the last image took.
  std::vector<compositor::RankLoad> ranks();
  int nodes() const { return service_->nodes(); }
  const volume::TexelFigures& values() const { return values_; }

  struct Histogram {
    double low = 0;  ///< as values of the volume: where the first bin begins
    double high = 1;
    std::vector<std::uint64_t> counts;
  };
  const Histogram& histogram() const { return histogram_; }

 private:
  Histogram measured_histogram();

  const FileScene& scene_;
  ServiceMaker make_;
  std::unique_ptr<compositor::LoadingService> service_;
  volume::TexelFigures values_;
  Histogram histogram_;
  // Of the last image.
  volume::RenderRequest request_;
  volume::ImageView image_;
  std::vector<float> kept_;  ///< its pixels, once the service's are gone
  std::size_t rays_looked_at_ = 0;
};

}  // namespace understudy::launcher
