// SPDX-License-Identifier: Apache-2.0
// How fast a trilinear field may change: bounds over cubes of a few cells.
//
// In a cell, the derivative along an axis interpolates the differences along its four edges, and a mixed second
// derivative the mixed differences of two faces; pure second derivatives are 0. From cell to cell the
// derivative across their face jumps by an interpolation of the texels' second differences.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "volume/brick/brick_store.h"

namespace understudy::volume {

/// Bounds over a cube of cells, in units of the texel type. Infinite if a texel is NaN.
struct Variation {
  std::array<float, 3> slope{};  ///< the greatest derivative along each axis, per cell
  std::array<float, 3> bend{};   ///< the greatest jump of that derivative at a face in or around the cube
  float twist = 0;               ///< the greatest mixed second derivative, per cell squared
};

class FieldVariation {
 public:
  static constexpr int cube_cells = 2;  ///< along an edge

  /// Covers the cells that the store holds; beyond the lattice's ends the field is constant.
  explicit FieldVariation(const BrickStore& store);

  /// Bounds over all cells that intersect the box between two positions, in lattice coordinates.
  Variation between(const std::array<float, 3>& a, const std::array<float, 3>& b) const;

  std::size_t bytes() const { return cubes_.size() * sizeof(Variation); }

 private:
  std::array<int, 3> first_{};   ///< the first cube, in cubes from the lattice's low corner
  std::array<int, 3> counts_{};  ///< numbers of cubes
  std::vector<Variation> cubes_;
};

}  // namespace understudy::volume
