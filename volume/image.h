// SPDX-License-Identifier: Apache-2.0
// Images as they are sent: premultiplied float RGBA over a rectangle of the framebuffer.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "volume/rect.h"

namespace understudy::volume {

/// A non-owning view of a rectangle of premultiplied RGBA float pixels; rows bottom up, four floats per pixel.
struct ImageView {
  Rect rect;
  std::span<const float> rgba;
};

/// An image that owns its pixels. It is transparent outside `rect`.
struct Image {
  Rect rect;
  std::vector<float> rgba;

  Image() = default;
  explicit Image(const Rect& where) : rect(where), rgba(4 * where.pixels(), 0.0F) {}

  /// The four floats of pixel (x, y), in window coordinates, inside `rect`.
  float* at(int x, int y) { return rgba.data() + 4 * (std::size_t(y - rect.y) * rect.width + (x - rect.x)); }
  const float* at(int x, int y) const {
    return rgba.data() + 4 * (std::size_t(y - rect.y) * rect.width + (x - rect.x));
  }
  ImageView view() const { return {rect, rgba}; }
};

/// Returns an image that owns a copy of the pixels of `view`.
inline Image copy_of(const ImageView& view) {
  Image image;
  image.rect = view.rect;
  image.rgba.assign(view.rgba.begin(), view.rgba.end());
  return image;
}

}  // namespace understudy::volume
