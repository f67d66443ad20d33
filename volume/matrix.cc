// SPDX-License-Identifier: Apache-2.0
#include "volume/matrix.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace understudy::volume {

double length(const Vec3& a) {
  return std::sqrt(dot(a, a));
}

Matrix4 multiply(const Matrix4& a, const Matrix4& b) {
  Matrix4 product{};
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      for (int k = 0; k < 4; ++k) product[4 * row + column] += a[4 * row + k] * b[4 * k + column];
  return product;
}

Vec4 transform(const Matrix4& m, const Vec4& v) {
  Vec4 image{};
  for (int row = 0; row < 4; ++row)
    for (int k = 0; k < 4; ++k) image[row] += m[4 * row + k] * v[k];
  return image;
}

namespace {

/// Scales the four elements from `first` on, `stride` apart (a row or a column), by the power of two that
/// brings the largest near one, which is exact, and multiplies `scale` by it. Returns false if no such power
/// exists.
bool balance(Matrix4& a, int first, int stride, double& scale) {
  double largest = 0;
  for (int k = 0; k < 4; ++k) largest = std::max(largest, std::abs(a[first + stride * k]));
  if (!(largest > 0) || !std::isfinite(largest)) return false;
  const double s = std::exp2(-std::ilogb(largest));
  if (!std::isfinite(s) || s == 0) return false;
  scale *= s;
  for (int k = 0; k < 4; ++k) a[first + stride * k] *= s;
  return true;
}

struct Pivot {
  int row = 0;
  int column = -1;
  double size = 0;
};

/// The largest element of the rows from `step` on, in columns without a pivot.
Pivot largest_pivot(const Matrix4& a, int step, const std::array<bool, 4>& used) {
  Pivot best{step, -1, 0};
  for (int i = step; i < 4; ++i)
    for (int k = 0; k < 4; ++k)
      if (!used[k] && std::abs(a[4 * i + k]) > best.size) best = {i, k, std::abs(a[4 * i + k])};
  return best;
}

/// One step of Gauss-Jordan elimination on [a | right]; moves the pivot to row `step` first.
void eliminate(Matrix4& a, Matrix4& right, int step, const Pivot& pivot) {
  for (int k = 0; k < 4; ++k) {
    std::swap(a[4 * pivot.row + k], a[4 * step + k]);
    std::swap(right[4 * pivot.row + k], right[4 * step + k]);
  }
  const double divisor = a[4 * step + pivot.column];
  for (int k = 0; k < 4; ++k) {
    a[4 * step + k] /= divisor;
    right[4 * step + k] /= divisor;
  }
  for (int i = 0; i < 4; ++i) {
    const double factor = a[4 * i + pivot.column];
    if (i == step || factor == 0) continue;
    for (int k = 0; k < 4; ++k) {
      a[4 * i + k] -= factor * a[4 * step + k];
      right[4 * i + k] -= factor * right[4 * step + k];
    }
  }
}

}  // namespace

std::optional<Matrix4> inverse(const Matrix4& m) {
  // m = R a C, where the largest elements of the rows and columns of `a` are near one.
  std::array<double, 4> row_scale{1, 1, 1, 1}, column_scale{1, 1, 1, 1};
  Matrix4 a = m;
  for (int sweep = 0; sweep < 4; ++sweep) {
    for (int i = 0; i < 4; ++i)
      if (!balance(a, 4 * i, 1, row_scale[i])) return std::nullopt;
    for (int i = 0; i < 4; ++i)
      if (!balance(a, i, 4, column_scale[i])) return std::nullopt;
  }

  // Gauss-Jordan elimination with full pivoting.
  constexpr double smallest_pivot = 1e-14;
  Matrix4 right = identity();
  std::array<int, 4> pivot_column{};
  std::array<bool, 4> used{};
  for (int step = 0; step < 4; ++step) {
    const Pivot pivot = largest_pivot(a, step, used);
    if (!(pivot.size > smallest_pivot)) return std::nullopt;
    used[pivot.column] = true;
    pivot_column[step] = pivot.column;
    eliminate(a, right, step, pivot);
  }

  Matrix4 result{};
  for (int step = 0; step < 4; ++step)
    for (int k = 0; k < 4; ++k) {
      const int row = pivot_column[step];
      result[4 * row + k] = right[4 * step + k] * column_scale[row] * row_scale[k];
      if (!std::isfinite(result[4 * row + k])) return std::nullopt;
    }
  return result;
}

HalfSpace transform_half_space(const Matrix4& inverse_of_forward, const HalfSpace& plane) {
  const Vec4 row{plane.normal[0], plane.normal[1], plane.normal[2], plane.offset};
  Vec4 image{};
  for (int column = 0; column < 4; ++column)
    for (int k = 0; k < 4; ++k) image[column] += row[k] * inverse_of_forward[4 * k + column];
  return {{image[0], image[1], image[2]}, image[3]};
}

}  // namespace understudy::volume
