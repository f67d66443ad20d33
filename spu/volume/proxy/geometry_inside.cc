// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/geometry_inside.h"

#include <algorithm>

#include "volume/matrix.h"
#include "volume/request.h"

namespace understudy::spu {

bool geometry_inside(const volume::RenderRequest& request, const volume::Matrix4& texture_to_clip,
                     const RaysThroughBox& rays) {
  if (!request.depth) return false;
  const auto [near, far] = request.depth_range;
  const auto window_depth = [&, near = near, far = far](const volume::Vec3& place) {
    const volume::Vec4 clip = volume::transform_point(texture_to_clip, place);
    return near + (far - near) * (clip[2] / clip[3] + 1) / 2;
  };
  // Precision of 16-bit depth: a plane that touches the box is not in it.
  constexpr double touching = 1.0 / 65536;
  const volume::DepthImage& depth = *request.depth;
  for (int row = 0; row < depth.rect.height; ++row) {
    for (int column = 0; column < depth.rect.width; ++column) {
      const float opaque = depth.depth[std::size_t(row) * std::size_t(depth.rect.width) + std::size_t(column)];
      if (opaque >= 1) continue;
      const double x = 2 * (depth.rect.x + column + 0.5 - request.viewport.x) / request.viewport.width - 1;
      const double y = 2 * (depth.rect.y + row + 0.5 - request.viewport.y) / request.viewport.height - 1;
      const auto through = rays.through(x, y);
      if (!through) continue;
      const double entry = window_depth(through->entry);
      const double exit = window_depth(volume::add(through->entry, through->way));
      if (opaque > std::min(entry, exit) + touching && opaque < std::max(entry, exit) - touching) return true;
    }
  }
  return false;
}

}  // namespace understudy::spu
