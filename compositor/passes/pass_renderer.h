// SPDX-License-Identifier: Apache-2.0
// Renders a volume in a file of which ranks hold one part at a time: the parts are loaded and rendered front
// first, and composited here. Parts are boxes of a kd-tree, like those of ranks, so images equal those of the
// whole volume to within rounding. A single part stays loaded.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "compositor/rendered.h"
#include "compositor/service/loading_service.h"
#include "volume/image.h"
#include "volume/kd_tree.h"

namespace understudy::volume {
class VolumeFile;
}

namespace understudy::compositor {

/// Figures of all images together.
struct PassFigures {
  int passes = 1;      ///< parts that the volume is divided into
  int loads = 0;       ///< parts that were loaded
  int empty = 0;       ///< parts not rendered, because nothing in them is visible under the transfer function
  int hidden = 0;      ///< parts not rendered, because they lie behind opaque ones
  double load_ms = 0;  ///< of the time of images and integrals
};

class PassRenderer : public ImageService {
 public:
  /// Called while part `pass` of `passes` is loaded.
  using Progress = std::function<void(int pass, int passes, std::span<const RankLoad> ranks)>;

  /// `service` and `file`, which is the volume's, must outlive this object. Throws std::invalid_argument if
  /// `parts` is not a partition of this volume.
  PassRenderer(LoadingService& service, const volume::VolumeFile& file, LoadRequest load,
               const volume::Partition& parts, Progress progress);

  /// Loads the volume. If there are several parts, determines the range of values of each: from the file if it
  /// has them, otherwise by reading all parts, the nearest in `view` last. Throws RequestRefused and
  /// ServiceLost, as all functions here do.
  void load(const volume::RenderRequest& view);

  Rendered render(const volume::RenderRequest& request) override;
  std::vector<volume::Image> images(std::span<const volume::RenderRequest> requests) override;
  bool loads_for_images() const override { return parts_.ranks() > 1; }
  /// Integrates all pixels if there are several parts, because loading takes longer than that.
  std::vector<volume::PixelIntegral> integrals(const volume::RenderRequest& request,
                                               std::span<const volume::Pixel> pixels, double most_ms) override;
  int nodes() const override { return service_.nodes(); }

  /// What each rank has read, and the most that it has held; times and samples are those of the last image.
  std::vector<RankLoad> ranks();
  const PassFigures& figures() const { return figures_; }

 private:
  /// Least and greatest; low > high: no values, except NaN.
  using Values = std::array<double, 2>;

  /// Loads a part for an image and adds the time to `load_ms`. Does nothing if the part is loaded already.
  void load_for_image(int part);
  void load_part(int part);
  bool may_show(const volume::RenderRequest& request, int part) const;
  /// The image of one request, as far as it is composited.
  struct Composite {
    volume::Image image;
    volume::FrameCounts counts;
    bool lossy = false;
  };
  /// Returns the request for the pixels in which this part can show something; null if there are none.
  std::optional<volume::RenderRequest> request_of_part(const volume::RenderRequest& request,
                                                       const volume::Image& image, int part) const;
  std::vector<Composite> composites(std::span<const volume::RenderRequest> requests);
  /// Adds the figures of the part that was rendered last to those of the other parts.
  void add_image_figures();

  LoadingService& service_;
  const volume::VolumeFile& file_;
  LoadRequest load_;
  volume::KdTree parts_;
  Progress progress_;
  std::vector<Values> values_;   ///< by part
  std::vector<bool> known_;      ///< by part: whether it was loaded before
  std::optional<int> loaded_;    ///< the part that ranks hold
  std::vector<RankLoad> ranks_;  ///< by rank: sums over the parts loaded so far
  PassFigures figures_;
  volume::Image image_;
};

}  // namespace understudy::compositor
