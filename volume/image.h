// Images as they travel: premultiplied float RGBA over a rectangle of the framebuffer.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace understudy::volume {

/// Half-open rectangle of pixels in window coordinates: x to the right, y up, as in glViewport.
struct Pixel {
  int x = 0;
  int y = 0;
  bool operator==(const Pixel&) const = default;
};

struct Rect {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  bool empty() const { return width <= 0 || height <= 0; }
  std::size_t pixels() const { return empty() ? 0 : std::size_t(width) * std::size_t(height); }
  bool operator==(const Rect&) const = default;
};

inline Rect intersection(const Rect& a, const Rect& b) {
  const int x0 = std::max(a.x, b.x), x1 = std::min(a.x + a.width, b.x + b.width);
  const int y0 = std::max(a.y, b.y), y1 = std::min(a.y + a.height, b.y + b.height);
  return x1 > x0 && y1 > y0 ? Rect{x0, y0, x1 - x0, y1 - y0} : Rect{};
}

/// Smallest rectangle that holds both; an empty one adds nothing.
inline Rect bounding(const Rect& a, const Rect& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  const int x0 = std::min(a.x, b.x), x1 = std::max(a.x + a.width, b.x + b.width);
  const int y0 = std::min(a.y, b.y), y1 = std::max(a.y + a.height, b.y + b.height);
  return {x0, y0, x1 - x0, y1 - y0};
}

/// A rectangle of premultiplied RGBA float pixels that somebody else owns; rows bottom up, four floats a pixel.
struct ImageView {
  Rect rect;
  std::span<const float> rgba;
};

/// An image that owns its pixels. Outside `rect` it is transparent.
struct Image {
  Rect rect;
  std::vector<float> rgba;

  Image() = default;
  explicit Image(const Rect& where) : rect(where), rgba(4 * where.pixels(), 0.0F) {}

  /// The four floats of pixel (x, y), given in window coordinates inside `rect`.
  float* at(int x, int y) { return rgba.data() + 4 * (std::size_t(y - rect.y) * rect.width + (x - rect.x)); }
  const float* at(int x, int y) const {
    return rgba.data() + 4 * (std::size_t(y - rect.y) * rect.width + (x - rect.x));
  }
  ImageView view() const { return {rect, rgba}; }
};

inline Image copy_of(const ImageView& view) {
  Image image;
  image.rect = view.rect;
  image.rgba.assign(view.rgba.begin(), view.rgba.end());
  return image;
}

}  // namespace understudy::volume
