// SPDX-License-Identifier: Apache-2.0
// The three- and four-dimensional linear algebra that a viewer needs, in double precision.
// Matrices are column-major as in OpenGL: element (row r, column c) is m[4*c + r].
#pragma once

#include <array>
#include <cmath>
#include <numbers>

namespace viewer {

using Vec3 = std::array<double, 3>;
using Vec3f = std::array<float, 3>;

inline Vec3 operator+(const Vec3& a, const Vec3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
inline Vec3 operator-(const Vec3& a, const Vec3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Vec3 operator*(double s, const Vec3& a) {
  return {s * a[0], s * a[1], s * a[2]};
}
/// Multiplies component by component.
inline Vec3 scale(const Vec3& a, const Vec3& b) {
  return {a[0] * b[0], a[1] * b[1], a[2] * b[2]};
}
inline double dot(const Vec3& a, const Vec3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline double length(const Vec3& a) {
  return std::sqrt(dot(a, a));
}
inline Vec3 normalised(const Vec3& a) {
  return (1.0 / length(a)) * a;
}
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Vec3f to_float(const Vec3& a) {
  return {static_cast<float>(a[0]), static_cast<float>(a[1]), static_cast<float>(a[2])};
}
inline double radians(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}

using Mat4 = std::array<double, 16>;
using Mat4f = std::array<float, 16>;

inline Mat4 operator*(const Mat4& a, const Mat4& b) {
  Mat4 product{};
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      for (int k = 0; k < 4; ++k) product[4 * column + row] += a[4 * k + row] * b[4 * column + k];
  return product;
}

inline Mat4 translation(const Vec3& t) {
  return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, t[0], t[1], t[2], 1};
}

inline Mat4 rotation_x(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {1, 0, 0, 0, 0, c, s, 0, 0, -s, c, 0, 0, 0, 0, 1};
}

inline Mat4 rotation_z(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c, s, 0, 0, -s, c, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
}

inline Mat4f to_float(const Mat4& a) {
  Mat4f narrowed;
  for (int i = 0; i < 16; ++i) narrowed[i] = static_cast<float>(a[i]);
  return narrowed;
}

}  // namespace viewer
