// SPDX-License-Identifier: Apache-2.0
// Double-precision linear algebra shared by the modules: row-major 4x4 matrices on column vectors, and vectors
// of three. Planes are represented as in texture_space.h (HalfSpace: normal . p + offset >= 0).
#pragma once

#include <optional>

#include "volume/texture_space.h"

namespace understudy::volume {

/// A homogeneous point, or the coefficients of a plane.
using Vec4 = std::array<double, 4>;

/// The identity matrix.
constexpr Matrix4 identity() {
  return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
}

/// a . b.
constexpr double dot(const Vec3& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
/// a x b, right-handed.
constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
constexpr Vec3 add(const Vec3& a, const Vec3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
constexpr Vec3 subtract(const Vec3& a, const Vec3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
constexpr Vec3 scale(const Vec3& a, double s) {
  return {a[0] * s, a[1] * s, a[2] * s};
}
/// Euclidean length.
double length(const Vec3& a);

/// The product a b: applies `b` first, then `a`.
Matrix4 multiply(const Matrix4& a, const Matrix4& b);

/// The product m v, not divided by its last component.
Vec4 transform(const Matrix4& m, const Vec4& v);

/// The homogeneous image of the point `p`.
inline Vec4 transform_point(const Matrix4& m, const Vec3& p) {
  return transform(m, {p[0], p[1], p[2], 1});
}

/// Empty when `m` holds a value that is not finite, or is singular to working precision: when a pivot falls
/// below 1e-14 after rows and columns were scaled to a largest entry near one. Scaling first distinguishes
/// valid extremes (anisotropy 1e6, near : far = 1e-12) from singular matrices.
std::optional<Matrix4> inverse(const Matrix4& m);

/// The half-space that contains the image of p under `forward` exactly when `plane` contains p. Takes the
/// inverse of the affine map `forward`.
HalfSpace transform_half_space(const Matrix4& inverse_of_forward, const HalfSpace& plane);

}  // namespace understudy::volume
