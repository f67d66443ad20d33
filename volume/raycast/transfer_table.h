// SPDX-License-Identifier: Apache-2.0
// A transfer function prepared for sampling: in units of the texel type, with every entry its difference to the
// next, and a constant-time test of whether anything shows within a range of values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "volume/brick/brick_store.h"
#include "volume/classification.h"
#include "volume/texel_type.h"

namespace understudy::volume {

/// Longest transfer function that is accepted.
constexpr std::size_t max_table_entries = 65536;

class TransferTable {
 public:
  /// `neutral` is the component that changes nothing in a composite: see neutral_value().
  TransferTable(const TransferFunction& function, TexelType type, float neutral);

  /// Position of a value in the table: clamp((value - low()) * scale(), 0, last()).
  float low() const { return low_; }
  float scale() const { return scale_; }
  float last() const { return float(entries_ - 1); }

  /// Eight floats per entry: RGBA and its difference to the next entry (0 after the last). An additional entry
  /// at index entries() holds `neutral` and leaves a composite unchanged.
  const float* rows() const { return rows_.data(); }
  std::size_t entries() const { return entries_; }

  /// Whether some value in [range.low, range.high] has colour or opacity. Exact: if all entries around the
  /// range are 0, so are interpolated values. Constant time, by prefix sums of visible entries.
  bool shows(const BrickStore::Range& range) const;

 private:
  float low_ = 0;
  float scale_ = 0;
  std::size_t entries_ = 0;
  std::vector<float> rows_;
  std::vector<std::uint32_t> showing_before_;  // number of visible entries among 0 .. i-1
};

}  // namespace understudy::volume
