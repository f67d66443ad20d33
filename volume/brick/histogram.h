// SPDX-License-Identifier: Apache-2.0
// How often values occur in a volume: each rank counts the texels of its own cells, so that sums over the ranks
// count every texel once.
#pragma once

#include <cstdint>
#include <vector>

namespace understudy::volume {

class BrickStore;

constexpr int max_histogram_bins = 256;

/// Bins of equal width over normalised texel values (u8: v/255, u16: v/65535, float: v) from `low` to `high`;
/// the last one is closed. What lies outside is not counted, and neither are values that are no numbers.
struct HistogramBins {
  double low = 0;
  double high = 1;
  int count = max_histogram_bins;
  bool operator==(const HistogramBins&) const = default;
};

/// Throws std::invalid_argument for bins without width, or too many.
void check(const HistogramBins& bins);

/// Of the texels at which the store's own cells begin; those on the upper rim of the volume belong to the last
/// cells. The store is finished and holds a scalar field. Throws std::invalid_argument.
std::vector<std::uint64_t> histogram(const BrickStore& store, const HistogramBins& bins);

}  // namespace understudy::volume
