// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/verification/kept_window.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <vector>

#include "spu/volume/verification/tile_comparison.h"
#include "volume/blending_operator.h"

namespace understudy::spu {
namespace {

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
  /// What is less than a step of 8 bits cannot be told from rounding.
  static constexpr float least_visible = 1.0F / 255;

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

/// Where a rectangle may end on each side; empty: not before the window does.
struct Edges {
  std::optional<int> left, bottom, right, top;
};

/// The edges of what `native` shows that `image` crosses.
Edges sharp_edges(const VisiblePixels& image, const VisiblePixels& native) {
  const volume::Rect shown = image.bounds(), drawn = native.bounds();
  if (shown.empty() || drawn.empty()) return {};
  const int right = drawn.x + drawn.width, top = drawn.y + drawn.height;
  const auto sharp = [&](const volume::Rect& edge) { return is_sharp(edge, native, image); };
  Edges edges;
  if (shown.x < drawn.x && sharp({drawn.x, drawn.y, 1, drawn.height})) edges.left = drawn.x;
  if (shown.y < drawn.y && sharp({drawn.x, drawn.y, drawn.width, 1})) edges.bottom = drawn.y;
  if (shown.x + shown.width > right && sharp({right - 1, drawn.y, 1, drawn.height})) edges.right = right;
  if (shown.y + shown.height > top && sharp({drawn.x, top - 1, drawn.width, 1})) edges.top = top;
  return edges;
}

/// `window` cut at some of the edges, those first that are cut at few.
std::vector<volume::Rect> cut_rects(const volume::Rect& window, const Edges& edges) {
  std::array<std::vector<volume::Rect>, 5> by_count;
  for (unsigned choice = 1; choice < 16; ++choice) {
    int left = window.x, bottom = window.y, right = window.x + window.width, top = window.y + window.height;
    bool possible = true;
    const auto end_at = [&](unsigned side, const std::optional<int>& edge, int& end) {
      if ((choice & side) == 0) return;
      possible = possible && edge;
      end = edge.value_or(end);
    };
    end_at(1, edges.left, left);
    end_at(2, edges.bottom, bottom);
    end_at(4, edges.right, right);
    end_at(8, edges.top, top);
    if (possible) by_count[std::popcount(choice)].push_back({left, bottom, right - left, top - bottom});
  }
  std::vector<volume::Rect> rects;
  for (const auto& some : by_count) rects.insert(rects.end(), some.begin(), some.end());
  return rects;
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
  // Few edges first: at a silhouette the images may differ by a pixel, which cuts nothing.
  for (const volume::Rect& kept : cut_rects(native.rect, sharp_edges(ours, theirs))) {
    const volume::Image within = cut(image, kept, background);
    if (difference_between(pipeline, native, within.view()).worst.within_bound()) return kept;
  }
  return std::nullopt;
}

}  // namespace understudy::spu
