// SPDX-License-Identifier: Apache-2.0
// How fast a trilinear field may change: bounds over cubes of a few cells.
//
// In a cell, the derivative along an axis interpolates the differences along its four edges, and a mixed second
// derivative the mixed differences of two faces; pure second derivatives are 0.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "volume/brick/brick_store.h"

namespace understudy::volume {

/// Bounds over a cube of cells, in units of the texel type. Infinite if a texel is NaN.
struct Variation {
  std::array<float, 3> slope{};  ///< the greatest derivative along each axis, per cell
  float twist = 0;               ///< the greatest mixed second derivative, per cell squared
};

class FieldVariation {
 public:
  static constexpr int cube_cells = 2;  ///< along an edge

  /// Covers the cells that the store holds; beyond the lattice's ends the field is constant.
  explicit FieldVariation(const BrickStore& store);

  /// Bounds over the cube of the cell that holds a position, in lattice coordinates.
  const Variation& at(const std::array<double, 3>& position) const;
  /// Bounds over all cells that intersect the box between two positions, in lattice coordinates.
  Variation between(const std::array<double, 3>& a, const std::array<double, 3>& b) const;

  std::size_t bytes() const { return cubes_.size() * sizeof(Variation); }

 private:
  /// The cube along an axis that holds a coordinate, or the nearest one.
  int cube_of(std::size_t axis, double position) const;
  const Variation& cube(int x, int y, int z) const;

  std::array<int, 3> first_{};   ///< the first cube, in cubes from the lattice's low corner
  std::array<int, 3> counts_{};  ///< numbers of cubes
  std::vector<Variation> cubes_;
};

}  // namespace understudy::volume
