// SPDX-License-Identifier: Apache-2.0
// A pre-integration table prepared for sampling: in units of the texel type, with a constant-time test of
// whether anything shows for two ranges of values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "volume/brick/brick_store.h"
#include "volume/classification.h"
#include "volume/texel_type.h"

namespace understudy::volume {

/// Longest edge of a pre-integration table that is accepted.
constexpr int max_pre_integration_edge = 1024;

/// Values at most this many entries beyond an end of the table are attributed to rounding.
constexpr float table_end_slack = 1e-3F;

class PreIntegrationLookup {
 public:
  /// `neutral` is the component that changes nothing in a composite: see neutral_value().
  PreIntegrationLookup(const PreIntegrationTable& table, TexelType type, float neutral);

  /// A value's position along either direction of the table: clamp((value - low()) * scale(), 0, last()).
  /// Interpolated between entries e = min(floor(position), edge() - 2) and e + 1.
  float low() const { return low_; }
  float scale() const { return scale_; }
  float last() const { return float(edge_ - 1); }
  int edge() const { return edge_; }
  bool multiply_by_alpha() const { return multiply_by_alpha_; }

  /// Four floats per entry, the front value varying fastest. The entry neutral_entry(), the one after it, and
  /// their counterparts in the next row leave a composite unchanged.
  const float* entries() const { return entries_.data(); }
  std::size_t neutral_entry() const { return std::size_t(edge_) * std::size_t(edge_); }

  /// Whether some pair of values from the two ranges has colour or opacity. Exact up to the support of the
  /// interpolation; constant time, by a summed-area table of visible entries.
  bool shows(const BrickStore::Range& front, const BrickStore::Range& back) const;

 private:
  float low_ = 0;
  float scale_ = 0;
  int edge_ = 0;
  bool multiply_by_alpha_ = true;
  std::vector<float> entries_;
  std::vector<std::uint32_t> showing_below_;  // (edge + 1)^2: visible entries with smaller indices in both
};

/// Per block, whether segments whose front lies in it can show something, given that their back lies at most
/// `reach` blocks away. With `keeps_clear`, true for all blocks except those without values.
std::vector<bool> blocks_with_slice_segments(const BrickStore& store, const PreIntegrationLookup& pairs,
                                             const std::array<int, 3>& reach, bool keeps_clear);

}  // namespace understudy::volume
