// SPDX-License-Identifier: Apache-2.0
// How fast a trilinear field may change: bounds over cubes of a few cells.
//
// In a cell the derivative along an axis is an interpolation of the differences along its four edges, and a
// mixed second derivative one of the mixed differences of two faces; pure second derivatives are 0. From cell
// to cell the derivative across their face jumps, by an interpolation of the second differences of its texels.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "volume/brick/brick_store.h"

namespace understudy::volume {

/// Of a cube of cells, in units of the texel type. Infinite where a texel is no number.
struct Variation {
  std::array<float, 3> slope{};  ///< the greatest derivative along each axis, per cell
  std::array<float, 3> bend{};   ///< the greatest jump of that at a face in or around the cube
  float twist = 0;               ///< the greatest mixed second derivative, per cell and cell
};

class FieldVariation {
 public:
  static constexpr int cube_cells = 2;  ///< along an edge

  /// Of what the store holds; beyond the lattice's ends the field is even.
  explicit FieldVariation(const BrickStore& store);

  /// Bounds over all cells that meet the box between two places, in lattice coordinates.
  Variation between(const std::array<float, 3>& a, const std::array<float, 3>& b) const;

  std::size_t bytes() const { return cubes_.size() * sizeof(Variation); }

 private:
  std::array<int, 3> first_{};   ///< the first cube, in cubes from the lattice's low corner
  std::array<int, 3> counts_{};  ///< of cubes
  std::vector<Variation> cubes_;
};

}  // namespace understudy::volume
