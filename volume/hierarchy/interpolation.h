// SPDX-License-Identifier: Apache-2.0
// Predicts a block of samples from every second one: the interpolating wavelets of Donoho 1992 (linear: those
// of Strengert et al. 2005), as a lifting scheme without its update step. For each sample, its difference from
// the prediction is stored.
//
// Along x, the samples between two known ones are predicted first, then along y, then along z, each from final
// samples: predicted samples are corrected before they predict others. Beyond the far faces of a block there is
// one additional layer. In it, the samples of the next level are known; those in between keep their
// predictions.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include "volume/hierarchy/level_grid.h"

namespace understudy::volume {

/// From the two neighbours along an axis, or from four where there are four.
enum class Prediction : std::uint8_t { linear = 0, cubic = 1 };

/// The extent of a block and of the layer beyond it.
struct BlockExtent {
  explicit BlockExtent(const TexelBox& samples) {
    for (std::size_t k = 0; k < 3; ++k) {
      inside[k] = samples.high[k] - samples.low[k];
      last[k] = (inside[k] + 1) / 2 * 2;
    }
  }
  std::size_t samples() const {
    return std::size_t(inside[0]) * std::size_t(inside[1]) * std::size_t(inside[2]);
  }
  /// Number of samples of the block that the next level does not have.
  std::size_t predicted() const {
    std::size_t known = 1;
    for (const int n : inside) known *= std::size_t((n + 1) / 2);
    return samples() - known;
  }
  std::size_t row() const { return std::size_t(last[0]) + 1; }
  std::size_t slice() const { return row() * (std::size_t(last[1]) + 1); }
  std::size_t points() const { return slice() * (std::size_t(last[2]) + 1); }
  std::size_t at(int x, int y, int z) const {
    return (std::size_t(z) * slice()) + (std::size_t(y) * row()) + std::size_t(x);
  }

  std::array<int, 3> inside{};  ///< samples of the block
  std::array<int, 3> last{};    ///< index of the layer beyond, which is even
};

namespace hierarchy_detail {

template <typename Sample>
using Wide = std::conditional_t<(sizeof(Sample) < 4), std::int32_t, std::int64_t>;

/// Predictions must have the same bits everywhere: values that are not finite are replaced by 0.
template <typename Sample>
Sample finite_or_zero(Sample value) {
  return std::abs(value) <= std::numeric_limits<Sample>::max() ? value : Sample(0);
}

template <typename Sample>
Sample from_two(Sample a, Sample b) {
  if constexpr (std::is_floating_point_v<Sample>) {
    return finite_or_zero(Sample(0.5) * a + Sample(0.5) * b);
  } else {
    return Sample((Wide<Sample>(a) + b + 1) >> 1);
  }
}

template <typename Sample>
Sample from_four(Sample before, Sample a, Sample b, Sample behind) {
  if constexpr (std::is_floating_point_v<Sample>) {
    return finite_or_zero(Sample(0.5625) * (a + b) - Sample(0.0625) * (before + behind));
  } else {
    using W = Wide<Sample>;
    const W value = (9 * (W(a) + b) - (W(before) + behind) + 8) >> 4;
    return Sample(std::clamp<W>(value, std::numeric_limits<Sample>::min(), std::numeric_limits<Sample>::max()));
  }
}

/// Predicts a row of samples from the rows at distance `away` on both sides, and if `four`, also at three times
/// that.
template <typename Sample>
void predict_row(const Sample* at, std::ptrdiff_t away, int count, bool four, Sample* predicted) {
  for (int i = 0; i < count; ++i)
    predicted[i] = four ? from_four(at[i - 3 * away], at[i - away], at[i + away], at[i + 3 * away])
                        : from_two(at[i - away], at[i + away]);
}

}  // namespace hierarchy_detail

/// Fills in the points between the even points of `points` (BlockExtent). Calls `correct(place, stride,
/// predicted, count)` for every row of samples in the block, the first at `place` and the others `stride` apart
/// along x, always in the same order; it must turn predictions into samples.
template <typename Sample, typename Correct>
void fill_between(const BlockExtent& extent, Prediction prediction, Sample* points, Correct&& correct) {
  using hierarchy_detail::from_four;
  using hierarchy_detail::from_two;
  using hierarchy_detail::predict_row;
  const auto [nx, ny, nz] = extent.inside;
  const auto [ex, ey, ez] = extent.last;
  const bool cubic = prediction == Prediction::cubic;
  const auto in_reach = [&](int i, int last) { return cubic && i >= 3 && i + 3 <= last; };
  std::array<Sample, hierarchy_block_edge + 1> row{};
  const auto row_stride = std::ptrdiff_t(extent.row());
  const auto slice_stride = std::ptrdiff_t(extent.slice());

  for (int z = 0; z <= ez; z += 2)
    for (int y = 0; y <= ey; y += 2) {
      Sample* const at = points + extent.at(0, y, z);
      for (int x = 1; x < ex; x += 2)
        row[std::size_t(x / 2)] = in_reach(x, ex) ? from_four(at[x - 3], at[x - 1], at[x + 1], at[x + 3])
                                                  : from_two(at[x - 1], at[x + 1]);
      if (z < nz && y < ny) correct(std::array{1, y, z}, 2, row.data(), nx / 2);
      for (int x = 1; x < ex; x += 2) at[x] = row[std::size_t(x / 2)];
    }
  for (int z = 0; z <= ez; z += 2)
    for (int y = 1; y < ey; y += 2) {
      Sample* const at = points + extent.at(0, y, z);
      predict_row(at, row_stride, ex + 1, in_reach(y, ey), row.data());
      if (z < nz && y < ny) correct(std::array{0, y, z}, 1, row.data(), nx);
      std::copy_n(row.begin(), ex + 1, at);
    }
  for (int z = 1; z < ez; z += 2)
    for (int y = 0; y < ny; ++y) {
      Sample* const at = points + extent.at(0, y, z);
      predict_row(at, slice_stride, nx, in_reach(z, ez), row.data());
      if (z < nz) correct(std::array{0, y, z}, 1, row.data(), nx);
      std::copy_n(row.begin(), nx, at);
    }
}

}  // namespace understudy::volume
