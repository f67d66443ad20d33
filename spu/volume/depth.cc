#include "spu/volume/depth.h"

#include <algorithm>

#include "spu/volume/saved_state.h"

namespace understudy::spu {

std::optional<volume::DepthImage> read_depth(const GlContext& context, const volume::Rect& rect,
                                             bool or_equal) {
  if (rect.empty()) return std::nullopt;
  const DispatchTable& gl = *context.gl;
  volume::DepthImage image;
  image.rect = rect;
  image.or_equal = or_equal;
  image.depth.assign(rect.pixels(), 1.0F);
  {
    const SavedState saved(context);
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, saved.draw_framebuffer());
    gl.ReadPixels(rect.x, rect.y, rect.width, rect.height, GL_DEPTH_COMPONENT, GL_FLOAT, image.depth.data());
  }
  const bool nothing = std::all_of(image.depth.begin(), image.depth.end(), [](float d) { return d >= 1.0F; });
  if (nothing) return std::nullopt;
  return image;
}

}  // namespace understudy::spu
