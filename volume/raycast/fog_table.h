// SPDX-License-Identifier: Apache-2.0
// Fog prepared for sampling: the position in its table as a function of lattice coordinates, and with every
// entry its difference to the next.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "volume/brick/brick_store.h"
#include "volume/fog.h"

namespace understudy::volume {

class FogTable {
 public:
  FogTable(const Fog& fog, const BrickStore& store);

  /// The position in the table for lattice position p: clamp(gradient() . p + offset(), 0, last()).
  const std::array<float, 3>& gradient() const { return gradient_; }
  float offset() const { return offset_; }
  float last() const { return float(last_); }

  /// Eight floats per entry: added colour and weight, and their difference to the next entry (0 after the
  /// last).
  const float* rows() const { return rows_.data(); }

 private:
  std::array<float, 3> gradient_{};
  float offset_ = 0;
  std::size_t last_ = 0;  ///< index of the last entry
  std::vector<float> rows_;
};

}  // namespace understudy::volume
