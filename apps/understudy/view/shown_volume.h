// SPDX-License-Identifier: Apache-2.0
// The volume that viewers look at, or the time steps of a series, behind a service that may be lost and made
// again.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "apps/understudy/cli/loading_nodes.h"
#include "apps/understudy/file_scene/file_scene.h"
#include "apps/understudy/file_scene/time_steps.h"
#include "apps/understudy/file_scene/volume_memory.h"
#include "apps/understudy/view/image_encoding.h"
#include "apps/understudy/view/view_state.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::launcher {

class ShownVolume {
 public:
  /// Of a series, as many time steps stay loaded as `memory` allows. `scene` outlives this.
  ShownVolume(const FileScene& scene, ServiceMaker make, RankMemory memory)
      : scene_(scene), make_(std::move(make)), memory_(std::move(memory)) {}

  const FileScene& scene() const { return scene_; }

  /// Makes a service, and has it read the volume, or the first time step that is shown; `progress` hears after
  /// every part how far the ranks are.
  /// Throws ServiceLost and RequestRefused.
  void load(const std::function<void(const std::vector<compositor::RankLoad>&)>& progress);

  // From here on the volume is loaded. What is lost throws ServiceLost; then load() again.

  struct Drawn {
    RgbImage image;
    volume::RenderRequest request;
    volume::FrameCounts counts;
    double ms = 0;       ///< to render and to composite, as it was waited for
    double load_ms = 0;  ///< before that, to read its time step
  };
  /// A time step that is not there is read first; what `progress` throws meanwhile is thrown on.
  Drawn draw(const ViewState& state, const TimeSteps::Progress& progress);
  /// Reads some of the time step that comes next, without forgetting those in use; false: there is nothing more
  /// to read. What was drawn last has no exactness() afterwards.
  bool read_ahead(std::span<const int> in_use);

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
  /// By which colours go: of the first step that was shown, or of all where their files tell them.
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
  RankMemory memory_;
  std::unique_ptr<compositor::LoadingService> service_;
  std::optional<TimeSteps> steps_;  ///< of this service
  volume::TexelFigures values_;
  Histogram histogram_;
  // Of the last image.
  volume::RenderRequest request_;
  volume::ImageView image_;
  std::vector<float> kept_;  ///< its pixels, once the service's are gone
  std::size_t rays_looked_at_ = 0;
};

}  // namespace understudy::launcher
