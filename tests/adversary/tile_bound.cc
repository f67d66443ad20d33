// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/tile_bound.h"

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <string>

namespace adversary {
namespace {

int excess(const Image& shown, const Image& bare, const Image& exact, std::size_t pixel) {
  int worst = 0;
  for (std::size_t channel = 4 * pixel; channel < 4 * pixel + 3; ++channel) {
    const auto [low, high] = std::minmax({bare.rgba[channel], exact.rgba[channel]});
    worst = std::max({worst, low - shown.rgba[channel], shown.rgba[channel] - high});
  }
  return worst;
}

int score(const Image& shown, const Image& bare, const Image& exact, int left, int below) {
  std::vector<int> excesses;
  for (int y = below; y < std::min(below + tile_edge, shown.height); ++y)
    for (int x = left; x < std::min(left + tile_edge, shown.width); ++x)
      excesses.push_back(excess(shown, bare, exact, static_cast<std::size_t>(y) * shown.width + x));
  const auto tolerated = excesses.begin() + static_cast<std::ptrdiff_t>(excesses.size() / 8);
  std::nth_element(excesses.begin(), tolerated, excesses.end(), std::greater<>());
  return *tolerated;
}

void require_size_of(const Image& image, const Image& other) {
  if (image.width != other.width || image.height != other.height)
    throw std::runtime_error("images of " + std::to_string(image.width) + "x" + std::to_string(image.height) +
                             " and " + std::to_string(other.width) + "x" + std::to_string(other.height) +
                             " cannot be compared");
}

}  // namespace

TileScore worst_tile(const Image& shown, const Image& bare, const Image& exact) {
  require_size_of(shown, bare);
  require_size_of(shown, exact);
  TileScore worst{-1};
  for (int y = 0; y < shown.height; y += tile_edge)
    for (int x = 0; x < shown.width; x += tile_edge)
      if (const int tile = score(shown, bare, exact, x, y); tile > worst.excess) worst = {tile, x, y};
  return worst;
}

}  // namespace adversary
