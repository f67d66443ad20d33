// SPDX-License-Identifier: Apache-2.0
// A voxel field along one ray, exactly: in a cell between eight texels, the linear filter yields a cubic.
#pragma once

#include <array>
#include <vector>

#include "volume/reference/slice_sum.h"
#include "volume/texture_space.h"

namespace understudy::volume {

/// value(u) = c[0] + c[1] u + c[2] u^2 + c[3] u^3, 0 <= u <= 1, over a stretch of a ray.
struct Cubic {
  std::array<double, 4> c{};

  double operator()(double u) const { return c[0] + u * (c[1] + u * (c[2] + u * c[3])); }
};

/// The part of a ray in one cell.
struct Stretch {
  double length = 0;             ///< in the unit of the whole ray's length
  std::array<Cubic, 4> value{};  ///< a scalar field uses the first
};

/// The lowest and the highest of the faces between cells that a path from `a` to `b`, positions along an axis
/// of `size` texels, may cross; low > high: none. Faces lie at whole positions. Beyond -1 and `size` there are
/// none, because the field is constant along the axis there.
std::array<int, 2> faces_between(double a, double b, int size);

/// The stretches of the straight path between two points of texture space, which is `length` long, in order.
/// Cells in which the field is NaN are skipped. `size` is the texture's, in texels.
std::vector<Stretch> field_along_ray(const Field& field, const std::array<int, 3>& size, const Vec3& from,
                                     const Vec3& to, double length);

/// The cubic through values at u = 0, 1/3, 2/3, 1.
Cubic cubic_through(const std::array<double, 4>& values);

/// Positions 0 < u < 1 where `cubic` crosses `value`, ascending. Where it only touches `value`, they are
/// accurate to the square root of the machine precision.
std::vector<double> crossings(const Cubic& cubic, double value);

/// 0, 1 and the extrema between them: the cubic is monotone from each to the next.
std::vector<double> monotone_parts(const Cubic& cubic);

}  // namespace understudy::volume
