// SPDX-License-Identifier: Apache-2.0
#include "volume/occlusion.h"

#include "volume/image.h"
#include "volume/request.h"

namespace understudy::volume {

namespace {

int tile_of(int pixel) {
  return pixel >= 0 ? pixel / occlusion_tile : -((-pixel + occlusion_tile - 1) / occlusion_tile);
}

}  // namespace

bool can_occlude(const RenderRequest& request) {
  return (request.op == Operator::over || request.op == Operator::first_hit) && request.termination > 0;
}

bool is_opaque(const Image& image, const Rect& rect, const RenderRequest& request) {
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    const float* pixel = image.at(rect.x, y);
    for (int x = 0; x < rect.width; ++x, pixel += 4)
      if (!(1 - pixel[3] < request.termination)) return false;
  }
  return true;
}

Rect tiles_touched(const Rect& rect) {
  if (rect.empty()) return {};
  const int x = tile_of(rect.x), y = tile_of(rect.y);
  return {x, y, tile_of(rect.x + rect.width - 1) + 1 - x, tile_of(rect.y + rect.height - 1) + 1 - y};
}

void cover_opaque_tiles(const Image& image, const RenderRequest& request, Occlusion& occlusion) {
  const Rect tiles = tiles_touched(image.rect);
  for (int row = tiles.y; row < tiles.y + tiles.height; ++row)
    for (int column = tiles.x; column < tiles.x + tiles.width; ++column) {
      const Rect tile = intersection(
          image.rect, {occlusion_tile * column, occlusion_tile * row, occlusion_tile, occlusion_tile});
      if (is_opaque(image, tile, request)) occlusion.cover(tile);
    }
}

}  // namespace understudy::volume
