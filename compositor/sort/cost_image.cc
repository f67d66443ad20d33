// SPDX-License-Identifier: Apache-2.0
#include "compositor/sort/cost_image.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "volume/occlusion.h"

namespace understudy::compositor {

using volume::Rect;

namespace {

/// Returns where the tiles of `first` to `first + length` begin, and where the last one ends.
std::vector<int> borders_of(int first, int length) {
  std::vector<int> borders{first};
  const int remainder = ((first % volume::occlusion_tile) + volume::occlusion_tile) % volume::occlusion_tile;
  for (int next = first - remainder + volume::occlusion_tile; next < first + length;
       next += volume::occlusion_tile)
    borders.push_back(next);
  borders.push_back(first + length);
  return borders;
}

/// A place between two borders: the lower border, and the fraction of the distance to the next.
struct Between {
  std::size_t border = 0;
  double part = 0;
};

Between place_between(const std::vector<int>& borders, int at) {
  const int inside = std::clamp(at, borders.front(), borders.back());
  const auto above = std::upper_bound(borders.begin(), borders.end() - 1, inside);
  const auto border = std::size_t(std::max<std::ptrdiff_t>(above - borders.begin() - 1, 0));
  const int length = borders[border + 1] - borders[border];
  return {border, double(inside - borders[border]) / double(length)};
}

}  // namespace

std::vector<Rect> tiles_of(const Rect& pixels) {
  if (pixels.empty()) return {};
  const std::vector<int> columns = borders_of(pixels.x, pixels.width);
  const std::vector<int> rows = borders_of(pixels.y, pixels.height);
  std::vector<Rect> tiles;
  tiles.reserve((columns.size() - 1) * (rows.size() - 1));
  for (std::size_t j = 0; j + 1 < rows.size(); ++j)
    for (std::size_t i = 0; i + 1 < columns.size(); ++i)
      tiles.push_back({columns[i], rows[j], columns[i + 1] - columns[i], rows[j + 1] - rows[j]});
  return tiles;
}

CostImage::CostImage(const Rect& pixels, std::span<const float> costs) : pixels_(pixels) {
  if (pixels.empty()) return;
  columns_ = borders_of(pixels.x, pixels.width);
  rows_ = borders_of(pixels.y, pixels.height);
  const std::size_t across = columns_.size();
  sums_.assign(across * rows_.size(), 0);
  for (std::size_t j = 1; j < rows_.size(); ++j) {
    double row = 0;
    for (std::size_t i = 1; i < across; ++i) {
      const float cost = costs[(j - 1) * (across - 1) + i - 1];
      row += cost > 0 && std::isfinite(cost) ? double(cost) : 0;
      sums_[j * across + i] = sums_[(j - 1) * across + i] + row;
    }
  }
}

double CostImage::below(int x, int y) const {
  const Between column = place_between(columns_, x);
  const Between row = place_between(rows_, y);
  const double* const low = &sums_[row.border * columns_.size() + column.border];
  const double* const high = low + columns_.size();
  const double under = low[0] + column.part * (low[1] - low[0]);
  const double over = high[0] + column.part * (high[1] - high[0]);
  return under + row.part * (over - under);
}

double CostImage::within(const Rect& rect) const {
  if (pixels_.empty() || rect.empty()) return 0;
  const int right = rect.x + rect.width;
  const int top = rect.y + rect.height;
  return below(right, top) - below(rect.x, top) - below(right, rect.y) + below(rect.x, rect.y);
}

}  // namespace understudy::compositor
