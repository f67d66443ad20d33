// SPDX-License-Identifier: Apache-2.0
// A transfer function made ready for sampling: in units of the texel type, with the slope to the next entry
// beside every entry, and able to say at once whether anything shows within a range of values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "volume/brick/brick_store.h"
#include "volume/classification.h"
#include "volume/texel_type.h"

namespace understudy::volume {

/// Longest transfer function that is believed.
constexpr std::size_t max_table_entries = 65536;

class TransferTable {
 public:
  /// `neutral` is what changes nothing in a composite: see neutral_value().
  TransferTable(const TransferFunction& function, TexelType type, float neutral);

  /// Position of a value in the table: clamp((value - low()) * scale(), 0, last()).
  float low() const { return low_; }
  float scale() const { return scale_; }
  float last() const { return float(entries_ - 1); }

  /// Per entry eight floats: RGBA and its difference to the next entry (0 after the last). One more entry,
  /// index entries(), is all 0: it leaves a composite as it is.
  const float* rows() const { return rows_.data(); }
  std::size_t entries() const { return entries_; }

  /// Whether some value in [range.low, range.high] has colour or opacity. Exact: entries under the range that
  /// are all 0 interpolate to 0. Constant time, by counting the entries that show (prefix sums).
  bool shows(const BrickStore::Range& range) const;

 private:
  float low_ = 0;
  float scale_ = 0;
  std::size_t entries_ = 0;
  std::vector<float> rows_;
  std::vector<std::uint32_t> showing_before_;  // how many of the entries 0 .. i-1 show
};

}  // namespace understudy::volume
