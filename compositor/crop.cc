// SPDX-License-Identifier: Apache-2.0
#include "compositor/crop.h"

#include <algorithm>
#include <cstring>

#include "volume/raycast/ray_caster.h"

namespace understudy::compositor {

using volume::Image;
using volume::Rect;

void crop_to_content(Image& image, volume::Operator op) {
  const float neutral = volume::neutral_value(op);
  const auto touched = [&](const float* first, const float* last) {
    return std::any_of(first, last, [&](float value) { return value != neutral; });
  };
  const Rect& rect = image.rect;
  const auto row_touched = [&](int y) {
    return touched(image.at(rect.x, y), image.at(rect.x, y) + 4 * std::size_t(rect.width));
  };
  if (rect.empty()) return;

  int y0 = rect.y, y1 = rect.y + rect.height;
  while (y0 < y1 && !row_touched(y0)) ++y0;
  while (y0 < y1 && !row_touched(y1 - 1)) --y1;
  // Each row is searched only outside the columns that are already known to be kept.
  int x0 = rect.x + rect.width, x1 = rect.x;
  for (int y = y0; y < y1; ++y) {
    for (int x = rect.x; x < x0; ++x)
      if (touched(image.at(x, y), image.at(x, y) + 4)) x0 = x;
    for (int x = rect.x + rect.width; x > x1; --x)
      if (touched(image.at(x - 1, y), image.at(x - 1, y) + 4)) x1 = x;
  }

  const Rect kept = y0 < y1 ? Rect{x0, y0, x1 - x0, y1 - y0} : Rect{};
  if (kept == rect) return;
  // Rows move towards the front of the same memory, so no row is overwritten before it has moved.
  const std::size_t row = 4 * std::size_t(kept.width);
  for (int y = 0; y < kept.height; ++y)
    std::memmove(image.rgba.data() + std::size_t(y) * row, image.at(kept.x, kept.y + y), row * sizeof(float));
  image.rgba.resize(4 * kept.pixels());
  image.rect = kept;
}

}  // namespace understudy::compositor
