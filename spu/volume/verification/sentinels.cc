// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/verification/sentinels.h"

#include <algorithm>

#include "spu/volume/verification/tile_comparison.h"
#include "volume/request.h"

namespace understudy::spu {
namespace {

constexpr int rim = 1;

}  // namespace

volume::Rect Sentinels::next_tile(const volume::Rect& window) {
  // Tiles that would stick out of the window are moved inside. If no such places were drawn, the pixels at the
  // window's edges would lie in fewer tiles than others.
  const auto place = [&](int low, int extent) {
    const int first = std::uniform_int_distribution<int>(1 - compared_tile_edge, extent - 1)(random_);
    return low + std::clamp(first, 0, std::max(extent - compared_tile_edge, 0));
  };
  const int x = place(window.x, window.width);
  const int y = place(window.y, window.height);
  return intersection(window, {x - rim, y - rim, compared_tile_edge + 2 * rim, compared_tile_edge + 2 * rim});
}

NativeDrawing& Sentinels::drawing(const GlContext& context, const Pipeline& pipeline,
                                  const volume::RenderRequest& request) {
  const volume::Rect& viewport = request.viewport;
  const bool white = pipeline.blending.op == volume::Operator::min;
  const std::array<int, 4> extent{viewport.x + viewport.width, viewport.y + viewport.height,
                                  pipeline.target.samples, white ? 1 : 0};
  if (!drawing_ || extent_ != extent) {
    drawing_ = std::make_unique<NativeDrawing>(context, pipeline, request);
    extent_ = extent;
  }
  return *drawing_;
}

}  // namespace understudy::spu
