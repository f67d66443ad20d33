// SPDX-License-Identifier: Apache-2.0
// Which blocks are empty, and how far a ray may skip: per block the Chebyshev distance to the nearest block
// that shows something, 0 for those that do. Around a block of distance d, all blocks fewer than d blocks away
// are empty. (Cohen, Sheffer 1994, proximity clouds; Deakin, Knackstedt 2020 for Chebyshev distance.)
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace understudy::volume {

class OccupancyMap {
 public:
  /// `shows` has one value per block of a box of `counts` blocks, x fastest. Everything outside the box counts
  /// as empty.
  OccupancyMap(const std::array<int, 3>& counts, std::vector<bool> shows);

  /// Distances, saturated at 255, followed by three padding bytes that may be read.
  const std::uint8_t* distances() const { return distances_.data(); }
  std::size_t empty_bricks() const { return empty_bricks_; }
  bool shows(std::size_t block) const { return distances_[block] == 0; }
  bool all_empty() const { return empty_bricks_ + 3 == distances_.size(); }

 private:
  std::vector<std::uint8_t> distances_;
  std::size_t empty_bricks_ = 0;
};

}  // namespace understudy::volume
