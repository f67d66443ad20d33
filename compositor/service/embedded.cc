// SPDX-License-Identifier: Apache-2.0
// The render service inside the application: one rank, all cores, no socket.
#include <array>

#include "compositor/rendered.h"
#include "compositor/service.h"
#include "compositor/service/integral_parts.h"
#include "compositor/service/rank_renderer.h"
#include "compositor/service/worker_threads.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::compositor {

namespace {

class EmbeddedService : public RenderService {
 public:
  void begin_volume(const volume::VolumeDescription& volume) override { renderer_.begin(application, volume); }
  void begin_change(volume::VolumeId id, std::uint64_t version) override {
    renderer_.begin_change({application, id}, version);
  }
  void add_texels(volume::VolumeId id, std::span<const volume::TexelBox> boxes,
                  std::span<const std::byte> texels) override {
    renderer_.check_texels({application, id}, boxes, texels.size());
    renderer_.add_texels({application, id}, boxes, texels);
  }
  void end_volume(volume::VolumeId id) override { renderer_.end({application, id}); }
  void forget_volume(volume::VolumeId id) override { renderer_.forget({application, id}); }

  Rendered render(const volume::RenderRequest& request) override {
    volume::FrameCounts counts;
    image_ = renderer_.render(application, request, counts);
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

  WorkerThreads threads_;
  RankRenderer renderer_{0, 1};
  volume::Image image_;
};

}  // namespace

std::unique_ptr<RenderService> embedded_service() {
  return std::make_unique<EmbeddedService>();
}

}  // namespace understudy::compositor
