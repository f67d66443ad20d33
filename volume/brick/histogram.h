// SPDX-License-Identifier: Apache-2.0
// Histogram of the values of a volume. Each rank counts the texels of its own cells, so that sums over the
// ranks count every texel once.
#pragma once

#include <cstdint>
#include <vector>

namespace understudy::volume {

class BrickStore;

constexpr int max_histogram_bins = 256;

/// Bins of equal width over normalised texel values (u8: v/255, u16: v/65535, float: v) from `low` to `high`;
/// the last one is closed. Values outside and NaN are not counted.
struct HistogramBins {
  double low = 0;
  double high = 1;
  int count = max_histogram_bins;
  bool operator==(const HistogramBins&) const = default;
};

/// Throws std::invalid_argument for an empty range, or an invalid number of bins.
void check(const HistogramBins& bins);

/// Counts the texels at the low corners of the store's own cells; texels on the upper boundary of the volume
/// belong to the last cells. The store must be finished and hold a scalar field. Throws std::invalid_argument.
std::vector<std::uint64_t> histogram(const BrickStore& store, const HistogramBins& bins);

}  // namespace understudy::volume
