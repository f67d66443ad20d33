// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/verification/tile_comparison.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "volume/blending_operator.h"

namespace understudy::spu {
namespace {

/// Less than half an 8-bit step is not visible.
constexpr float least_visible = 0.5F / 255;

/// RGBA as the framebuffer shows it, row by row.
struct ShownImage {
  int width = 0;
  int height = 0;
  std::vector<float> rgba;

  const float* at(int x, int y) const {
    return &rgba[4 * (std::size_t(y) * std::size_t(width) + std::size_t(x))];
  }
};

/// Shows colours like the framebuffer that both images are for.
class Display {
 public:
  Display(const Pipeline& pipeline, const NativeImage& native)
      : minimum_(pipeline.blending.op == volume::Operator::min), floating_(pipeline.target.floating) {
    if (floating_ && !native.rgba.empty())
      largest_ = std::max(1.0F, *std::max_element(native.rgba.begin(), native.rgba.end()));
  }

  float background() const { return minimum_ ? 1.0F : 0.0F; }
  float shown(float value) const {
    // A NaN is shown as 0.
    const float number = std::isnan(value) ? 0.0F : value;
    const float seen = minimum_ ? std::min(number, 1.0F) : number;
    return floating_ ? seen / largest_ : std::clamp(seen, 0.0F, 1.0F);
  }

 private:
  bool minimum_;
  bool floating_;
  float largest_ = 1;
};

ShownImage shown(const NativeImage& native, const Display& display) {
  ShownImage image{native.rect.width, native.rect.height, native.rgba};
  for (float& value : image.rgba) value = display.shown(value);
  return image;
}

/// Returns the part of `image` that lies in `rect`, with the background around it.
ShownImage shown(const volume::ImageView& image, const volume::Rect& rect, const Display& display) {
  ShownImage part{rect.width, rect.height, {}};
  part.rgba.assign(4 * rect.pixels(), display.shown(display.background()));
  const volume::Rect both = intersection(rect, image.rect);
  for (int y = both.y; y < both.y + both.height; ++y) {
    const float* from = image.rgba.data() + 4 * (std::size_t(y - image.rect.y) * std::size_t(image.rect.width) +
                                                 std::size_t(both.x - image.rect.x));
    float* to = part.rgba.data() +
                4 * (std::size_t(y - rect.y) * std::size_t(rect.width) + std::size_t(both.x - rect.x));
    for (int i = 0; i < 4 * both.width; ++i) to[i] = display.shown(from[i]);
  }
  return part;
}

/// Returns how far `value` lies outside of the range of a channel of `image` within one pixel of (x, y).
float outside(float value, const ShownImage& image, int x, int y, std::size_t channel) {
  float low = std::numeric_limits<float>::max();
  float high = std::numeric_limits<float>::lowest();
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, image.height - 1); ++v) {
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, image.width - 1); ++u) {
      low = std::min(low, image.at(u, v)[channel]);
      high = std::max(high, image.at(u, v)[channel]);
    }
  }
  return std::max({0.0F, low - value, value - high});
}

float excess(const ShownImage& a, const ShownImage& b, int x, int y) {
  float largest = 0;
  for (std::size_t c = 0; c < 4; ++c) {
    const float va = a.at(x, y)[c], vb = b.at(x, y)[c];
    // Most colours of a right image are about equal; their neighbours need not be compared.
    if (std::abs(va - vb) <= std::max(largest, least_visible)) continue;
    largest = std::max({largest, outside(va, b, x, y, c), outside(vb, a, x, y, c)});
  }
  return largest;
}

float difference_at(const ShownImage& a, const ShownImage& b, int x, int y) {
  float largest = 0;
  for (std::size_t c = 0; c < 4; ++c) largest = std::max(largest, std::abs(a.at(x, y)[c] - b.at(x, y)[c]));
  return largest;
}

TileDifference difference_of_tile(const ShownImage& a, const ShownImage& b, int x0, int y0) {
  const int x1 = std::min(x0 + compared_tile_edge, a.width), y1 = std::min(y0 + compared_tile_edge, a.height);
  TileDifference tile{.tile = {x0, y0, x1 - x0, y1 - y0}, .pixel = {x0, y0}};
  std::array<float, compared_tile_edge * compared_tile_edge> differences{};
  std::size_t pixels = 0;
  float largest = 0;
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      differences[pixels++] = difference_at(a, b, x, y);
      const float e = excess(a, b, x, y);
      tile.excess += e;
      if (e > largest) {
        largest = e;
        tile.pixel = {x, y};
      }
    }
  }
  // A tile that the window cuts off counts only by what it shows.
  tile.excess /= compared_tile_edge * compared_tile_edge;
  const auto eighth = differences.begin() + differences.size() / 8;
  std::nth_element(differences.begin(), eighth, differences.end(), std::greater<>());
  tile.common = *eighth;
  return tile;
}

bool shows_something(const ShownImage& image, float background) {
  return std::any_of(image.rgba.begin(), image.rgba.end(),
                     [&](float value) { return std::abs(value - background) > least_visible; });
}

void add_squares(const ShownImage& a, const ShownImage& b, ImageDifference& difference) {
  double sum = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) {
    const double d = std::abs(double(a.rgba[i]) - double(b.rgba[i]));
    difference.max = std::max(difference.max, d);
    sum += d * d;
  }
  if (!a.rgba.empty()) difference.mean_square = sum / double(a.rgba.size());
}

}  // namespace

double ImageDifference::psnr() const {
  return mean_square > 0 ? -10.0 * std::log10(mean_square) : std::numeric_limits<double>::infinity();
}

ImageDifference difference_between(const Pipeline& pipeline, const NativeImage& native,
                                   const volume::ImageView& image) {
  const Display display(pipeline, native);
  const ShownImage theirs = shown(native, display);
  const ShownImage ours = shown(image, native.rect, display);
  ImageDifference difference;
  add_squares(theirs, ours, difference);
  for (int y = 0; y < theirs.height; y += compared_tile_edge) {
    for (int x = 0; x < theirs.width; x += compared_tile_edge) {
      const TileDifference tile = difference_of_tile(theirs, ours, x, y);
      if (tile.severity() >= difference.worst.severity()) difference.worst = tile;
    }
  }
  for (int* coordinate : {&difference.worst.tile.x, &difference.worst.pixel[0]}) *coordinate += native.rect.x;
  for (int* coordinate : {&difference.worst.tile.y, &difference.worst.pixel[1]}) *coordinate += native.rect.y;
  const float background = display.shown(display.background());
  difference.anything_visible = shows_something(theirs, background) || shows_something(ours, background);
  return difference;
}

}  // namespace understudy::spu
