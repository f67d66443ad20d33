// SPDX-License-Identifier: Apache-2.0
// The space in which a program measures the angles of its light, and directions in it as one ray sees them.
#pragma once

#include <array>
#include <cstddef>

#include "volume/texture_space.h"

namespace understudy::spu {

class LightSpace {
 public:
  /// `space` is row-major and regular, from texture space; the ray goes along `way` in texture space.
  LightSpace(const std::array<double, 9>& space, const volume::Vec3& way);

  /// In texture space, of a field that falls fastest at `angle` to the direction to the eye, turned about the
  /// ray; its largest component is 1.
  volume::Vec3 gradient(double angle, double turn) const;

  /// Between the direction to the eye and the normal of a field that rises along a texture axis.
  double cosine_across(std::size_t axis) const;

 private:
  volume::Vec3 row_of(std::size_t row) const {
    return {space_[3 * row], space_[3 * row + 1], space_[3 * row + 2]};
  }

  std::array<double, 9> space_;
  volume::Vec3 to_eye_{}, right_{}, up_{};
};

}  // namespace understudy::spu
