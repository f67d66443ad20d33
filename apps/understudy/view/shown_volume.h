// SPDX-License-Identifier: Apache-2.0
// The displayed volume, or the time steps of a series, behind a service that may be lost and reconnected.
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
  /// `scene` must outlive this object. Of a series, as many time steps stay loaded as `memory` allows.
  ShownVolume(const FileScene& scene, ServiceMaker make, RankMemory memory)
      : scene_(scene), make_(std::move(make)), memory_(std::move(memory)) {}

  const FileScene& scene() const { return scene_; }

  /// Makes a service and loads the volume, or the first time step to be shown. Calls `progress` with the state
  /// of the ranks after every part. Throws ServiceLost and RequestRefused.
  void load(const std::function<void(const std::vector<compositor::RankLoad>&)>& progress);

  // The following functions require a loaded volume. If the service is lost, they throw
  // ServiceLost; call load() again.

  struct Drawn {
    RgbImage image;
    volume::RenderRequest request;
    volume::FrameCounts counts;
    double ms = 0;       ///< time to render and composite, as seen by the caller
    double load_ms = 0;  ///< time to read its time step before that
  };
  /// Reads the time step first if it is not loaded; rethrows what `progress` throws.
  Drawn draw(const ViewState& state, const TimeSteps::Progress& progress);
  /// Reads a further part of the next time step, without removing those in use; returns false if there is
  /// nothing more to read. Afterwards, exactness() of the last image is not available.
  bool read_ahead(std::span<const int> in_use);

  struct Exactness {
    double error = 0;  ///< greatest difference of a channel from the integral, over the rays
    std::size_t rays = 0;
  };
  /// Checks the last image, with different rays in each call; returns nothing if it has no integral
  /// (surfaces, light, other operators).
  std::optional<Exactness> exactness();

  /// Returns what each rank holds, and the cost of its part of the last image.
  std::vector<compositor::RankLoad> ranks();
  int nodes() const { return service_->nodes(); }
  /// The range of values that the transfer function refers to: of the first step that was shown, or of all
  /// steps if their files specify it.
  const volume::TexelFigures& values() const { return values_; }

  struct Histogram {
    double low = 0;  ///< begin of the first bin, as a value of the volume
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
  std::optional<TimeSteps> steps_;  ///< of service_
  volume::TexelFigures values_;
  Histogram histogram_;
  // Of the last image.
  volume::RenderRequest request_;
  volume::ImageView image_;
  std::vector<float> kept_;  ///< copy of its pixels, for calls that invalidate the service's
  std::size_t rays_looked_at_ = 0;
};

}  // namespace understudy::launcher
