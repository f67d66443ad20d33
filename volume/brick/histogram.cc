// SPDX-License-Identifier: Apache-2.0
#include "volume/brick/histogram.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include "volume/brick/brick_store.h"
#include "volume/cell_lattice.h"
#include "volume/texel_box.h"
#include "volume/texel_type.h"

namespace understudy::volume {
namespace {

using Counts = std::vector<std::uint64_t>;

/// The range of a block's points along one axis whose texels this store counts.
struct Run {
  int first = 0;
  int end = 0;
};

/// One run per block along `axis`. A texel may be at several lattice points; it is counted at the first one.
std::vector<Run> counted_points(const BrickStore& store, int axis) {
  const CellLattice& lattice = store.lattice();
  const TexelBox& owned = store.owned_cells();
  const int first = owned.low[axis] - lattice.origin[axis];
  int end = owned.high[axis] - lattice.origin[axis];
  if (end == lattice.cells[axis]) ++end;  // the upper boundary
  std::vector<bool> seen(std::size_t(store.description().size[axis]), false);
  std::vector<bool> counts(std::size_t(lattice.cells[axis] + 1), false);
  for (int point = 0; point <= lattice.cells[axis]; ++point) {
    const auto texel = std::size_t(lattice_texel(store.description(), lattice, axis, point));
    counts[std::size_t(point)] = !seen[texel] && point >= first && point < end;
    seen[texel] = true;
  }
  std::vector<Run> runs;
  constexpr int cells = BrickStore::block_cells;
  for (int block = 0; block < store.block_counts()[std::size_t(axis)]; ++block) {
    const int start = cells * (store.first_block()[std::size_t(axis)] + block);
    // The last point of a block is the first of the next block, if there is one.
    const int stop = std::min(start + cells, lattice.cells[axis]) == lattice.cells[axis]
                         ? lattice.cells[axis] + 1
                         : start + cells;
    Run run;
    for (int point = start; point < stop; ++point) {
      if (!counts[std::size_t(point)]) continue;
      if (run.end == 0) run.first = point - start;
      run.end = point - start + 1;
    }
    runs.push_back(run);
  }
  return runs;
}

/// The bin of a texel, or `count` if it has none.
template <typename Texel>
class BinOf {
 public:
  explicit BinOf(const HistogramBins& bins) : low_(bins.low), high_(bins.high), count_(bins.count) {
    per_unit_ = bins.count / (bins.high - bins.low);
    if constexpr (std::is_integral_v<Texel>) {
      constexpr int top = std::numeric_limits<Texel>::max();
      table_.resize(std::size_t(top) + 1);
      for (int texel = 0; texel <= top; ++texel) table_[std::size_t(texel)] = computed(double(texel) / top);
    }
  }
  std::size_t operator()(Texel texel) const {
    if constexpr (std::is_integral_v<Texel>)
      return table_[texel];
    else
      return computed(double(texel));
  }

 private:
  std::uint16_t computed(double value) const {
    if (!(value >= low_ && value <= high_)) return std::uint16_t(count_);  // also for NaN
    return std::uint16_t(std::min(int((value - low_) * per_unit_), count_ - 1));
  }

  double low_;
  double high_;
  int count_;
  double per_unit_ = 0;
  std::vector<std::uint16_t> table_;
};

template <typename Texel>
Counts counted(const BrickStore& store, const HistogramBins& bins) {
  const BinOf<Texel> bin_of(bins);
  const std::array<std::vector<Run>, 3> runs{counted_points(store, 0), counted_points(store, 1),
                                             counted_points(store, 2)};
  const std::array<int, 3>& blocks = store.block_counts();
  const auto count_block = [&](std::size_t b, const Run& x_run, const Run& y_run, const Run& z_run,
                               Counts& counts) {
    const std::byte* const data = store.block_data()[b];
    const BrickStore::Range& range = store.ranges(b).front();
    // Ranges ignore NaN, which only float texels can hold.
    if (std::is_integral_v<Texel> && range.low == range.high) {
      counts[bin_of(Texel(range.low))] += std::uint64_t(x_run.end - x_run.first) *
                                          std::uint64_t(y_run.end - y_run.first) *
                                          std::uint64_t(z_run.end - z_run.first);
      return;
    }
    for (int z = z_run.first; z < z_run.end; ++z)
      for (int y = y_run.first; y < y_run.end; ++y) {
        const int row = z * BrickStore::block_slice + y * BrickStore::block_row;
        for (int x = x_run.first; x < x_run.end; ++x) {
          Texel texel;
          std::memcpy(&texel, data + std::size_t(row + x) * sizeof texel, sizeof texel);
          ++counts[bin_of(texel)];
        }
      }
  };
  const Counts none(std::size_t(bins.count) + 1, 0);
  Counts counts = tbb::parallel_reduce(
      tbb::blocked_range<int>(0, blocks[2]), none,
      [&](const tbb::blocked_range<int>& layers, Counts sums) {
        for (int z = layers.begin(); z < layers.end(); ++z)
          for (int y = 0; y < blocks[1]; ++y)
            for (int x = 0; x < blocks[0]; ++x) {
              const std::size_t b =
                  (std::size_t(z) * std::size_t(blocks[1]) + std::size_t(y)) * std::size_t(blocks[0]) +
                  std::size_t(x);
              count_block(b, runs[0][std::size_t(x)], runs[1][std::size_t(y)], runs[2][std::size_t(z)], sums);
            }
        return sums;
      },
      [](Counts a, const Counts& b) {
        std::ranges::transform(a, b, a.begin(), std::plus<>());
        return a;
      });
  counts.pop_back();  // texels without a bin
  return counts;
}

}  // namespace

void check(const HistogramBins& bins) {
  if (!(std::isfinite(bins.low) && std::isfinite(bins.high) && bins.low < bins.high))
    throw std::invalid_argument(
        fmt::format("a histogram from {} to {} has no width; give the least value first", bins.low, bins.high));
  if (bins.count < 1 || bins.count > max_histogram_bins)
    throw std::invalid_argument(
        fmt::format("a histogram of {} bins; give 1 to {}", bins.count, max_histogram_bins));
}

std::vector<std::uint64_t> histogram(const BrickStore& store, const HistogramBins& bins) {
  check(bins);
  switch (store.description().type) {
    case TexelType::u8:
      return counted<std::uint8_t>(store, bins);
    case TexelType::u16:
      return counted<std::uint16_t>(store, bins);
    case TexelType::f32:
      return counted<float>(store, bins);
    case TexelType::rgba8:
      break;
  }
  throw std::invalid_argument("a histogram is of scalars; this volume's texels are colours");
}

}  // namespace understudy::volume
