// SPDX-License-Identifier: Apache-2.0
#include "volume/raycast/brick_renderer.h"

#include <algorithm>

#include "volume/brick/brick_store.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/occlusion.h"
#include "volume/raycast/ray_caster.h"
#include "volume/rect.h"
#include "volume/request.h"

namespace understudy::volume {

namespace {

class CpuRenderer final : public BrickRenderer {
 public:
  explicit CpuRenderer(const BrickStore& store) : caster_(store) {}
  void blocks_changed(std::span<const std::size_t> blocks) override { caster_.blocks_changed(blocks); }
  void estimate_costs(const RenderRequest& request, std::span<const Rect> tiles,
                      std::span<float> costs) override {
    caster_.estimate_costs(request, tiles, costs);
  }

 private:
  void draw(const RenderRequest& request, Image& out, FrameCounts& counts, Occlusion* occlusion) override {
    caster_.render(request, out, counts, occlusion);
  }

  RayCaster caster_;
};

}  // namespace

void BrickRenderer::estimate_costs(const RenderRequest& /*request*/, std::span<const Rect> tiles,
                                   std::span<float> costs) {
  std::ranges::transform(tiles, costs.begin(), [](const Rect& tile) { return float(tile.pixels()); });
}

std::unique_ptr<BrickRenderer> cpu_renderer(const BrickStore& store) {
  return std::make_unique<CpuRenderer>(store);
}

}  // namespace understudy::volume
