// SPDX-License-Identifier: Apache-2.0
// Renders a volume whole, and in the parts of several ranks, with any ray caster.
#pragma once

#include <algorithm>
#include <functional>

#include "tests/volume/scenes.h"
#include "volume/footprint.h"
#include "volume/frame_counts.h"
#include "volume/image.h"
#include "volume/kd_tree.h"
#include "volume/raycast/ray_caster.h"
#include "volume/request.h"

namespace understudy::volume::testing {

/// Draws one rank's bricks, as raycast() does.
using DrawBricks = std::function<void(const BrickStore&, const RenderRequest&, Image&, FrameCounts&)>;

struct Whole {
  Image image;
  FrameCounts counts;
};

inline Whole render_whole(const Texture& texture, const RenderRequest& request,
                          const DrawBricks& draw = raycast) {
  Whole whole{Image(request.window), {}};
  const BrickStore store = filled(texture);
  draw(store, request, whole.image, whole.counts);
  return whole;
}

/// Each rank renders its own footprint; the images are composited in visibility order.
inline Whole render_parts(const Texture& texture, const RenderRequest& request, const KdTree& tree,
                          const DrawBricks& draw = raycast) {
  Whole whole{Image(request.window), {}};
  std::fill(whole.image.rgba.begin(), whole.image.rgba.end(), neutral_value(request.op));
  for (const int rank : tree.visibility_order(request)) {
    const BrickStore store = filled(texture, tree.box(rank));
    Image part(footprint(request, texture.description, tree.box(rank)));
    draw(store, request, part, whole.counts);
    for (int y = part.rect.y; y < part.rect.y + part.rect.height; ++y)
      for (int x = part.rect.x; x < part.rect.x + part.rect.width; ++x) {
        float* front = whole.image.at(x, y);
        const float* back = part.at(x, y);
        const float room = 1 - front[3];
        for (int k = 0; k < 4; ++k) switch (request.op) {
            case Operator::over:
            case Operator::first_hit:
              front[k] += room * back[k];
              break;
            case Operator::add:
              front[k] += back[k];
              break;
            case Operator::max:
              front[k] = std::max(front[k], back[k]);
              break;
            case Operator::min:
              front[k] = std::min(front[k], back[k]);
              break;
          }
      }
  }
  return whole;
}

inline Whole render_parts(const Texture& texture, const RenderRequest& request, int ranks,
                          const DrawBricks& draw = raycast) {
  return render_parts(texture, request, KdTree(texture.description, ranks), draw);
}

}  // namespace understudy::volume::testing
