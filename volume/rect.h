// SPDX-License-Identifier: Apache-2.0
// Pixels and rectangles of pixels, in window coordinates.
#pragma once

#include <algorithm>
#include <cstddef>

namespace understudy::volume {

/// A pixel in window coordinates: x to the right, y up, as in glViewport.
struct Pixel {
  int x = 0;
  int y = 0;
  bool operator==(const Pixel&) const = default;
};

/// Pixels x to x + width - 1 and y to y + height - 1.
struct Rect {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  bool empty() const { return width <= 0 || height <= 0; }
  std::size_t pixels() const { return empty() ? 0 : std::size_t(width) * std::size_t(height); }
  bool operator==(const Rect&) const = default;
};

/// Empty, at (0, 0), if they share no pixel.
inline Rect intersection(const Rect& a, const Rect& b) {
  const int x0 = std::max(a.x, b.x), x1 = std::min(a.x + a.width, b.x + b.width);
  const int y0 = std::max(a.y, b.y), y1 = std::min(a.y + a.height, b.y + b.height);
  return x1 > x0 && y1 > y0 ? Rect{x0, y0, x1 - x0, y1 - y0} : Rect{};
}

/// Smallest rectangle that contains both; an empty one adds nothing.
inline Rect bounding(const Rect& a, const Rect& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  const int x0 = std::min(a.x, b.x), x1 = std::max(a.x + a.width, b.x + b.width);
  const int y0 = std::min(a.y, b.y), y1 = std::max(a.y + a.height, b.y + b.height);
  return {x0, y0, x1 - x0, y1 - y0};
}

}  // namespace understudy::volume
