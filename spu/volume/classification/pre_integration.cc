// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/classification/pre_integration.h"

#include <algorithm>
#include <cmath>

namespace understudy::spu {
namespace {

/// Multiples of 1/255 fall on entries of either edge, so that tables over 8-bit values keep their steps.
constexpr int finest_edge = 2 * 255 + 1;
constexpr int coarse_edge = 255 + 1;

/// Colours between entries of a coarse table may be off by about one 8-bit step, to which drivers round samples
/// of 8-bit textures, but on average by almost nothing.
constexpr double same_entry = 4e-3;
constexpr double same_mean = 1e-4;

float value_at(const std::array<float, 2>& range, int entry) {
  const double place = double(std::min(entry, finest_edge - 1)) / (finest_edge - 1);
  return float(range[0] + place * (double(range[1]) - range[0]));
}

SegmentValues tile_of(const std::array<float, 2>& range, int first) {
  SegmentValues values{};
  for (std::size_t i = 0; i < segment_tile; ++i) values[i] = value_at(range, first + int(i));
  return values;
}

const volume::Rgba& entry_at(const volume::PreIntegrationTable& table, int front, int back) {
  return table.entries[std::size_t(back) * std::size_t(table.edge) + std::size_t(front)];
}

/// Returns whether every second entry, interpolated, gives the others.
bool coarse_suffices(const volume::PreIntegrationTable& fine) {
  double sum = 0;
  for (int back = 0; back < fine.edge; ++back) {
    for (int front = 0; front < fine.edge; ++front) {
      const int x = front % 2;
      const int y = back % 2;
      for (std::size_t c = 0; c < 4; ++c) {
        const double told =
            (double(entry_at(fine, front - x, back - y)[c]) + entry_at(fine, front + x, back - y)[c] +
             entry_at(fine, front - x, back + y)[c] + entry_at(fine, front + x, back + y)[c]) /
            4;
        const double off = told - entry_at(fine, front, back)[c];
        if (!(std::abs(off) <= same_entry)) return false;
        sum += off;
      }
    }
  }
  return std::abs(sum) <= same_mean * 4 * double(fine.entries.size());
}

}  // namespace

volume::PreIntegrationTable measure_segments(const ColoursOfPairs& colours, const std::array<float, 2>& range,
                                             bool premultiplied) {
  volume::PreIntegrationTable fine;
  fine.low = range[0];
  fine.high = range[1];
  fine.edge = finest_edge;
  fine.multiply_by_alpha = !premultiplied;
  fine.entries.resize(std::size_t(finest_edge) * std::size_t(finest_edge));
  constexpr int tile = int(segment_tile);
  for (int back = 0; back < finest_edge; back += tile) {
    for (int front = 0; front < finest_edge; front += tile) {
      const std::vector<volume::Rgba> seen = colours(tile_of(range, front), tile_of(range, back));
      const int width = std::min(tile, finest_edge - front);
      for (int y = 0; y < std::min(tile, finest_edge - back); ++y) {
        std::copy_n(seen.begin() + std::ptrdiff_t(y) * tile, width,
                    fine.entries.begin() + std::ptrdiff_t(back + y) * finest_edge + front);
      }
    }
  }
  if (!coarse_suffices(fine)) return fine;
  volume::PreIntegrationTable coarse = fine;
  coarse.edge = coarse_edge;
  coarse.entries.clear();
  for (int back = 0; back < finest_edge; back += 2) {
    for (int front = 0; front < finest_edge; front += 2) coarse.entries.push_back(entry_at(fine, front, back));
  }
  return coarse;
}

std::array<volume::Rgba, 2> colours_around(const volume::PreIntegrationTable& table, double front, double back,
                                           double entries) {
  const auto bounds = [&](double place) {
    const double at = place * (table.edge - 1);
    return std::array{int(std::clamp(std::floor(at - entries), 0.0, table.edge - 1.0)),
                      int(std::clamp(std::ceil(at + entries), 0.0, table.edge - 1.0))};
  };
  const auto [x0, x1] = bounds(front);
  const auto [y0, y1] = bounds(back);
  std::array<volume::Rgba, 2> around{entry_at(table, x0, y0), entry_at(table, x0, y0)};
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      for (std::size_t c = 0; c < 4; ++c) {
        around[0][c] = std::min(around[0][c], entry_at(table, x, y)[c]);
        around[1][c] = std::max(around[1][c], entry_at(table, x, y)[c]);
      }
    }
  }
  return around;
}

}  // namespace understudy::spu
