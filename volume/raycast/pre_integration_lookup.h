// SPDX-License-Identifier: Apache-2.0
// A pre-integration table made ready for sampling: in units of the texel type, and able to say at once whether
// anything shows for two ranges of values.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "volume/brick/brick_store.h"
#include "volume/classification.h"
#include "volume/texel_type.h"

namespace understudy::volume {

/// Longest edge of a pre-integration table that is believed.
constexpr int max_pre_integration_edge = 1024;

/// Values no further than so many entries beyond an end of a table are rounding.
constexpr float table_end_slack = 1e-3F;

class PreIntegrationLookup {
 public:
  /// `neutral` is what changes nothing in a composite: see neutral_value().
  PreIntegrationLookup(const PreIntegrationTable& table, TexelType type, float neutral);

  /// Place of a value in either direction of the table: clamp((value - low()) * scale(), 0, last()). Between
  /// entries e = min(floor(place), edge() - 2) and e + 1 it is interpolated.
  float low() const { return low_; }
  float scale() const { return scale_; }
  float last() const { return float(edge_ - 1); }
  int edge() const { return edge_; }
  bool multiply_by_alpha() const { return multiply_by_alpha_; }

  /// Per entry four floats, the front's running faster. From entry neutral_entry() on, an entry, the next, and
  /// those of the next row are such that they leave a composite as it is.
  const float* entries() const { return entries_.data(); }
  std::size_t neutral_entry() const { return std::size_t(edge_) * std::size_t(edge_); }

  /// Whether some pair of values from the two ranges has colour or opacity. Exact up to the interpolation's
  /// reach; constant time, by a summed-area table of the entries that show.
  bool shows(const BrickStore::Range& front, const BrickStore::Range& back) const;

 private:
  float low_ = 0;
  float scale_ = 0;
  int edge_ = 0;
  bool multiply_by_alpha_ = true;
  std::vector<float> entries_;
  std::vector<std::uint32_t> showing_below_;  // (edge + 1)^2: entries that show with smaller indices in both
};

/// Per block which segments whose front lies in it can show something, when their back lies no more than
/// `reach` blocks away. With `keeps_clear`, all but blocks without values can.
std::vector<bool> blocks_with_slice_segments(const BrickStore& store, const PreIntegrationLookup& pairs,
                                             const std::array<int, 3>& reach, bool keeps_clear);

}  // namespace understudy::volume
