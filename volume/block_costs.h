// SPDX-License-Identifier: Apache-2.0
// What the parts of a volume cost, in any unit that adds up (samples, milliseconds, blocks that show
// something): one number for each cube of so many cells.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "volume/texel_box.h"

namespace understudy::volume {

/// Values of cubes that tile the lattice; sums over boxes of them are CostSums.
class BlockCosts {
 public:
  /// Of the cells `lattice`, in cubes of `edge` cells, a multiple of a block's (those at the upper rim may be
  /// smaller); all cost nothing yet. Throws std::invalid_argument.
  BlockCosts(const TexelBox& lattice, int edge);

  const TexelBox& lattice() const { return lattice_; }
  int edge() const { return edge_; }
  const std::array<int, 3>& counts() const { return counts_; }

  /// One per cube, x fastest.
  std::span<double> values() { return values_; }
  std::span<const double> values() const { return values_; }
  std::size_t index(const std::array<int, 3>& cube) const {
    return (std::size_t(cube[2]) * std::size_t(counts_[1]) + std::size_t(cube[1])) * std::size_t(counts_[0]) +
           std::size_t(cube[0]);
  }

  /// The cubes whose lowest cell lies in `cells`: boxes that tile the lattice divide the cubes among them.
  TexelBox cubes_of(const TexelBox& cells) const;

 private:
  TexelBox lattice_;
  int edge_ = 0;
  std::array<int, 3> counts_{};
  std::vector<double> values_;
};

/// Sums over boxes, each in constant time. (Crow 1984, with one dimension more.) Exact for integers.
class CostSums {
 public:
  explicit CostSums(const BlockCosts& costs);

  const BlockCosts& costs() const { return *costs_; }
  /// Of the cubes whose lowest cell lies in `cells`.
  double within(const TexelBox& cells) const;

 private:
  const BlockCosts* costs_;
  std::vector<double> sums_;  // of all cubes below, with one more layer of zeros at the low sides
};

}  // namespace understudy::volume
