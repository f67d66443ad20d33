// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/verification/kept_window.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "spu/volume/verification/tile_comparison.h"
#include "volume/blending_operator.h"

namespace understudy::spu {
namespace {

/// What is less than a step of 8 bits cannot be told from rounding.
constexpr float least_visible = 1.0F / 255;

/// Which pixels of a rectangle show something.
class VisiblePixels {
 public:
  VisiblePixels(const volume::Rect& rect, std::span<const float> rgba, float background)
      : rect_(rect), rgba_(rgba), background_(background) {}

  bool at(int x, int y) const {
    if (x < rect_.x || y < rect_.y || x >= rect_.x + rect_.width || y >= rect_.y + rect_.height) return false;
    const std::size_t pixel = std::size_t(y - rect_.y) * std::size_t(rect_.width) + std::size_t(x - rect_.x);
    const auto colour = rgba_.subspan(4 * pixel, 4);
    return std::ranges::any_of(colour,
                               [&](float value) { return std::abs(value - background_) > least_visible; });
  }

  /// The smallest rectangle that holds all of them.
  volume::Rect bounds() const {
    int left = rect_.x + rect_.width, right = rect_.x, bottom = rect_.y + rect_.height, top = rect_.y;
    for (int y = rect_.y; y < rect_.y + rect_.height; ++y) {
      for (int x = rect_.x; x < rect_.x + rect_.width; ++x) {
        if (!at(x, y)) continue;
        left = std::min(left, x);
        right = std::max(right, x + 1);
        bottom = std::min(bottom, y);
        top = std::max(top, y + 1);
      }
    }
    if (right <= left) return {};
    return {left, bottom, right - left, top - bottom};
  }

 private:
  volume::Rect rect_;
  std::span<const float> rgba_;
  float background_;
};

/// Whether most pixels of `edge`, a row or a column, that `image` shows are shown by `native`, too: a
/// silhouette thins out towards its end, what is discarded does not.
bool is_sharp(const volume::Rect& edge, const VisiblePixels& native, const VisiblePixels& image) {
  int both = 0, shown = 0;
  for (int y = edge.y; y < edge.y + edge.height; ++y) {
    for (int x = edge.x; x < edge.x + edge.width; ++x) {
      if (!image.at(x, y)) continue;
      ++shown;
      both += native.at(x, y) ? 1 : 0;
    }
  }
  return 2 * both > shown;
}

volume::Image cut(const volume::ImageView& image, const volume::Rect& rect, float background) {
  volume::Image kept = copy_of(image);
  for (int y = 0; y < image.rect.height; ++y) {
    for (int x = 0; x < image.rect.width; ++x) {
      const volume::Rect pixel{image.rect.x + x, image.rect.y + y, 1, 1};
      if (!intersection(rect, pixel).empty()) continue;
      const auto first = kept.rgba.begin() + 4 * (std::ptrdiff_t(y) * image.rect.width + x);
      std::fill(first, first + 4, background);
    }
  }
  return kept;
}

}  // namespace

std::optional<volume::Rect> kept_rect(const Pipeline& pipeline, const NativeImage& native,
                                      const volume::ImageView& image) {
  const float background = pipeline.blending.op == volume::Operator::min ? 1.0F : 0.0F;
  const VisiblePixels ours(image.rect, image.rgba, background);
  const VisiblePixels theirs(native.rect, native.rgba, background);
  const volume::Rect shown = intersection(ours.bounds(), native.rect), drawn = theirs.bounds();
  if (shown.empty() || drawn.empty()) return std::nullopt;
  // Edges that do not cut are those of the compared window.
  int left = native.rect.x, bottom = native.rect.y;
  int right = native.rect.x + native.rect.width, top = native.rect.y + native.rect.height;
  const auto cuts = [&](bool beyond, const volume::Rect& edge) {
    return beyond && is_sharp(edge, theirs, ours);
  };
  if (cuts(shown.x < drawn.x, {drawn.x, drawn.y, 1, drawn.height})) left = drawn.x;
  if (cuts(shown.y < drawn.y, {drawn.x, drawn.y, drawn.width, 1})) bottom = drawn.y;
  const int drawn_right = drawn.x + drawn.width, drawn_top = drawn.y + drawn.height;
  if (cuts(shown.x + shown.width > drawn_right, {drawn_right - 1, drawn.y, 1, drawn.height}))
    right = drawn_right;
  if (cuts(shown.y + shown.height > drawn_top, {drawn.x, drawn_top - 1, drawn.width, 1})) top = drawn_top;
  const volume::Rect kept{left, bottom, right - left, top - bottom};
  if (kept == native.rect) return std::nullopt;
  if (!difference_between(pipeline, native, cut(image, kept, background).view()).worst.within_bound())
    return std::nullopt;
  return kept;
}

}  // namespace understudy::spu
