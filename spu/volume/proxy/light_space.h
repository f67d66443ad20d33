// SPDX-License-Identifier: Apache-2.0
// The space in which a program measures the angles of its light, and directions in it relative to one ray.
#pragma once

#include <array>
#include <cstddef>

#include "volume/light.h"
#include "volume/texture_space.h"

namespace understudy::spu {

class LightSpace {
 public:
  /// Uses the light's `space` and `ray_space`; the ray goes along `way` in texture space.
  LightSpace(const volume::Light& light, const volume::Vec3& way);

  /// Returns the gradient, in texture space, of a field that falls fastest at `angle` to the direction to the
  /// eye, turned about the ray; its largest component is 1.
  volume::Vec3 gradient(double angle, double turn) const;

  /// The cosine between the direction to the eye and the normal of a field with this gradient in texture space.
  double cosine(const volume::Vec3& gradient) const;
  /// The slope of a field with this gradient, per unit of length of the light's space.
  double slope(const volume::Vec3& gradient) const;
  /// The cosine for a field that rises along a texture axis.
  double cosine_across(std::size_t axis) const {
    volume::Vec3 gradient{};
    gradient[axis] = 1;
    return cosine(gradient);
  }

 private:
  volume::Vec3 normal(const volume::Vec3& gradient) const;

  std::array<double, 9> space_;
  double determinant_ = 0;
  std::array<volume::Vec3, 3> normals_{};  ///< in the space, of fields that rise along a texture axis
  volume::Vec3 to_eye_{}, right_{}, up_{};
};

}  // namespace understudy::spu
