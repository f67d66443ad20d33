// SPDX-License-Identifier: Apache-2.0
// One rank in this process, which reads its files itself.
#include <array>

#include "compositor/rendered.h"
#include "compositor/service/integral_parts.h"
#include "compositor/service/loading_service.h"
#include "compositor/service/loads.h"
#include "compositor/service/rank_renderer.h"
#include "compositor/service/worker_threads.h"
#include "volume/brick/histogram.h"
#include "volume/file/file_error.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::compositor {

namespace {

class EmbeddedLoadingService : public LoadingService {
 public:
  std::vector<RankLoad> begin_load(const LoadRequest& request) override {
    return told(key_of(request.volume.id), [&](VolumeKey key) { loads_.begin(key, request); });
  }
  std::vector<RankLoad> continue_load(volume::VolumeId id) override {
    return told(key_of(id), [&](VolumeKey key) { loads_.read_on(key); });
  }

  std::vector<std::uint64_t> histogram(volume::VolumeId id, const volume::HistogramBins& bins) override {
    return renderer_.histogram(key_of(id), bins);
  }

  void begin_volume(const volume::VolumeDescription& volume) override {
    loads_.forget(key_of(volume.id));
    renderer_.begin(application, volume);
  }
  void begin_change(volume::VolumeId id, std::uint64_t version) override {
    renderer_.begin_change(key_of(id), version);
  }
  void add_texels(volume::VolumeId id, std::span<const volume::TexelBox> boxes,
                  std::span<const std::byte> texels) override {
    renderer_.check_texels(key_of(id), boxes, texels.size());
    renderer_.add_texels(key_of(id), boxes, texels);
  }
  void end_volume(volume::VolumeId id) override { renderer_.end(key_of(id)); }
  void forget_volume(volume::VolumeId id) override {
    loads_.forget(key_of(id));
    renderer_.forget(key_of(id));
  }
  Rendered render(const volume::RenderRequest& request) override {
    volume::FrameCounts counts;
    image_ = renderer_.render(application, request, counts);
    loads_.drew(key_of(request.volume), counts);
    return {image_.view(), counts};
  }
  std::vector<volume::PixelIntegral> integrals(const volume::RenderRequest& request,
                                               std::span<const volume::Pixel> pixels, double most_ms) override {
    const std::vector<IntegralPart> whole = renderer_.integrals(application, request, pixels, most_ms);
    return composed_integrals({&whole, 1}, std::array{0});
  }

  int nodes() const override { return 0; }

 private:
  static constexpr std::uint64_t application = 0;
  static VolumeKey key_of(volume::VolumeId id) { return {application, id}; }

  template <class Step>
  std::vector<RankLoad> told(VolumeKey key, Step step) {
    try {
      step(key);
    } catch (const volume::FileError& error) {
      loads_.forget(key);
      renderer_.forget(key);
      throw RequestRefused(error.what());
    }
    const RankLoad figures = loads_.figures(key);
    if (figures.done()) loads_.complete(key);
    return {figures};
  }

  WorkerThreads threads_;
  RankRenderer renderer_{0, 1};
  Loads loads_{renderer_, 0};
  volume::Image image_;
};

}  // namespace

std::unique_ptr<LoadingService> embedded_loading_service() {
  return std::make_unique<EmbeddedLoadingService>();
}

}  // namespace understudy::compositor
