// SPDX-License-Identifier: Apache-2.0
// Where sentinels lie, and the framebuffer into which the application's own drawing of them is repeated.
#pragma once

#include <array>
#include <memory>
#include <random>

#include "spu/volume/verification/native_image.h"

namespace understudy::spu {

class Sentinels {
 public:
  /// Returns a tile at a random position in `window`, in which no pixel is rarer than others, with a rim of one
  /// pixel: the tile's pixels are compared with their neighbours, too.
  volume::Rect next_tile(const volume::Rect& window);
  /// Returns the framebuffer for tiles of `request`. It is kept until the viewport's extent, the number of
  /// samples or the background changes; what was drawn into it is not removed.
  NativeDrawing& drawing(const GlContext& context, const Pipeline& pipeline,
                         const volume::RenderRequest& request);

 private:
  std::unique_ptr<NativeDrawing> drawing_;
  std::array<int, 4> extent_{};  ///< of drawing_: width, height, samples, whether its background is white
  std::minstd_rand random_;
};

}  // namespace understudy::spu
