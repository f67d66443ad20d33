// SPDX-License-Identifier: Apache-2.0
// Images of a volume in a file, of which ranks hold one part at a time: the parts are loaded and rendered front
// first, and composited here. They are boxes of a kd-tree as those of ranks are, so that images are those of
// the whole volume, to within rounding. A single part stays loaded.
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

/// Of all images together.
struct PassFigures {
  int passes = 1;  ///< parts that the volume is divided into
  int loads = 0;   ///< of parts
  int empty = 0;   ///< parts that were not shown, for nothing in them is visible under the transfer function
  int hidden = 0;  ///< parts that were not shown, behind what is opaque
  double load_ms = 0;  ///< of the time that images and integrals took
};

class PassRenderer : public ImageService {
 public:
  /// While part `pass` of `passes` is loaded.
  using Progress = std::function<void(int pass, int passes, std::span<const RankLoad> ranks)>;

  /// `service` and `file`, the volume's, outlive this. Throws std::invalid_argument when `parts` are not of
  /// this volume.
  PassRenderer(LoadingService& service, const volume::VolumeFile& file, LoadRequest load,
               const volume::Partition& parts, Progress progress);

  /// Loads the volume. Of parts it finds out which values each has: all are read, the nearest in `view` last,
  /// but for a file that tells its values. Throws RequestRefused and ServiceLost, as everything here does.
  void load(const volume::RenderRequest& view);

  Rendered render(const volume::RenderRequest& request) override;
  std::vector<volume::Image> images(std::span<const volume::RenderRequest> requests) override;
  bool loads_for_images() const override { return parts_.ranks() > 1; }
  /// Of parts all pixels are integrated: loading takes longer.
  std::vector<volume::PixelIntegral> integrals(const volume::RenderRequest& request,
                                               std::span<const volume::Pixel> pixels, double most_ms) override;
  int nodes() const override { return service_.nodes(); }

  /// What each rank has read, and the most that it has held; times and samples are those of the last image.
  std::vector<RankLoad> ranks();
  const PassFigures& figures() const { return figures_; }

 private:
  /// Least and greatest; low > high: none, but for not-a-numbers.
  using Values = std::array<double, 2>;

  /// Of an image. Nothing where it is loaded already.
  void load_for_image(int part);
  void load_part(int part);
  bool may_show(const volume::RenderRequest& request, int part) const;
  /// What is composited of a request.
  struct Composite {
    volume::Image image;
    volume::FrameCounts counts;
  };
  /// The request for the pixels in which this part can show something, if there are any.
  std::optional<volume::RenderRequest> request_of_part(const volume::RenderRequest& request,
                                                       const volume::Image& image, int part) const;
  std::vector<Composite> composites(std::span<const volume::RenderRequest> requests);
  /// Adds what the last image took to those of the other parts.
  void add_image_figures();

  LoadingService& service_;
  const volume::VolumeFile& file_;
  LoadRequest load_;
  volume::KdTree parts_;
  Progress progress_;
  std::vector<Values> values_;   ///< by part
  std::vector<bool> known_;      ///< parts that have been loaded
  std::optional<int> loaded_;    ///< part
  std::vector<RankLoad> ranks_;  ///< of the parts that have been loaded
  PassFigures figures_;
  volume::Image image_;
};

}  // namespace understudy::compositor
