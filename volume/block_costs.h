// SPDX-License-Identifier: Apache-2.0
// Costs of the parts of a volume, in any additive unit (samples, milliseconds, visible blocks): one value per
// cube of cells.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "volume/texel_box.h"

namespace understudy::volume {

/// One value per cube; the cubes tile the lattice. CostSums sums the values over boxes.
class BlockCosts {
 public:
  /// For the cells of `lattice`, in cubes of `edge` cells, a multiple of block_cells (cubes at the upper
  /// boundary may be smaller). All costs start at 0. Throws std::invalid_argument.
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

  /// The cubes whose lowest cell lies in `cells`. Boxes that tile the lattice partition the cubes.
  TexelBox cubes_of(const TexelBox& cells) const;

 private:
  TexelBox lattice_;
  int edge_ = 0;
  std::array<int, 3> counts_{};
  std::vector<double> values_;
};

/// Sums over boxes, in constant time each (summed-area table, Crow 1984, in 3D). Exact for integers.
class CostSums {
 public:
  explicit CostSums(const BlockCosts& costs);

  const BlockCosts& costs() const { return *costs_; }
  /// Sum over the cubes whose lowest cell lies in `cells`.
  double within(const TexelBox& cells) const;

 private:
  const BlockCosts* costs_;
  std::vector<double> sums_;  // prefix sums, exclusive, with one layer of zeros at the low sides
};

}  // namespace understudy::volume
