// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/geometry/fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace understudy::spu {
namespace {

using Symmetric3 = std::array<std::array<double, 3>, 3>;

/// Returns the Cholesky factor of a symmetric positive definite 3x3 matrix; null if a pivot falls below `floor`
/// times the largest diagonal entry, as it does for points in a plane (a single slice).
std::optional<Symmetric3> cholesky(const Symmetric3& m, double floor) {
  const double largest = std::max({m[0][0], m[1][1], m[2][2]});
  Symmetric3 l{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      double sum = m[i][j];
      for (int k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
      if (i == j) {
        if (!(sum > floor * largest)) return std::nullopt;
        l[i][i] = std::sqrt(sum);
      } else {
        l[i][j] = sum / l[j][j];
      }
    }
  }
  return l;
}

volume::Vec3 solve(const Symmetric3& l, const volume::Vec3& right) {
  volume::Vec3 y{};
  for (int i = 0; i < 3; ++i) {
    y[i] = right[i];
    for (int k = 0; k < i; ++k) y[i] -= l[i][k] * y[k];
    y[i] /= l[i][i];
  }
  for (int i = 2; i >= 0; --i) {
    for (int k = i + 1; k < 3; ++k) y[i] -= l[k][i] * y[k];
    y[i] /= l[i][i];
  }
  return y;
}

/// The mean of all vertices, and their extent around it. Centring keeps the precision of a volume far from the
/// origin (offset 1e7).
struct Centre {
  volume::Vec3 texture{};
  std::array<double, 4> clip{};
  volume::Vec3 scale{};  ///< of texture coordinates
};

/// Null if vertices are not finite, or do not span texture space.
std::optional<Centre> centre_of(std::span<const ObservedVertex> vertices) {
  Centre centre;
  for (const ObservedVertex& v : vertices) {
    for (int i = 0; i < 3; ++i) centre.texture[i] += v.texture[i];
    for (int i = 0; i < 4; ++i) centre.clip[i] += v.clip[i];
  }
  const double n = double(vertices.size());
  for (double& x : centre.texture) x /= n;
  for (double& x : centre.clip) x /= n;
  for (double x : centre.clip) {
    if (!std::isfinite(x)) return std::nullopt;
  }
  for (const ObservedVertex& v : vertices) {
    for (int i = 0; i < 3; ++i)
      centre.scale[i] = std::max(centre.scale[i], std::abs(v.texture[i] - centre.texture[i]));
  }
  for (double s : centre.scale) {
    if (!(s > 0) || !std::isfinite(s)) return std::nullopt;
  }
  return centre;
}

/// Returns the largest deviation of a vertex from the map, relative to the extent of the clip positions.
double residual_of(std::span<const ObservedVertex> vertices, const volume::Matrix4& texture_to_clip,
                   const Centre& centre) {
  double extent = 0;
  double deviation = 0;
  for (const ObservedVertex& v : vertices) {
    for (int row = 0; row < 4; ++row) {
      const double* a = &texture_to_clip[4 * row];
      const double predicted = a[0] * v.texture[0] + a[1] * v.texture[1] + a[2] * v.texture[2] + a[3];
      deviation = std::max(deviation, std::abs(predicted - v.clip[row]));
      extent = std::max(extent, std::abs(v.clip[row] - centre.clip[row]));
    }
  }
  return extent > 0 ? deviation / extent : std::numeric_limits<double>::infinity();
}

}  // namespace

std::optional<CameraFit> fit_camera(std::span<const ObservedVertex> vertices) {
  if (vertices.size() < 4) return std::nullopt;
  const auto centre = centre_of(vertices);
  if (!centre) return std::nullopt;
  const volume::Vec3& scale = centre->scale;

  Symmetric3 normal{};
  std::array<volume::Vec3, 4> right{};
  for (const ObservedVertex& v : vertices) {
    volume::Vec3 t{};
    for (int i = 0; i < 3; ++i) t[i] = (v.texture[i] - centre->texture[i]) / scale[i];
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) normal[i][j] += t[i] * t[j];
      for (int row = 0; row < 4; ++row) right[row][i] += t[i] * (v.clip[row] - centre->clip[row]);
    }
  }
  // Two of N slices are at least 1/N apart: squared and scaled, that is far above 1e-10, and float noise is far
  // below.
  const auto factor = cholesky(normal, 1e-10);
  if (!factor) return std::nullopt;

  CameraFit fit;
  for (int row = 0; row < 4; ++row) {
    const volume::Vec3 solution = solve(*factor, right[row]);
    double constant = centre->clip[row];
    for (int i = 0; i < 3; ++i) {
      fit.texture_to_clip[4 * row + i] = solution[i] / scale[i];
      constant -= solution[i] / scale[i] * centre->texture[i];
    }
    fit.texture_to_clip[4 * row + 3] = constant;
  }
  fit.residual = residual_of(vertices, fit.texture_to_clip, *centre);
  if (!std::isfinite(fit.residual)) return std::nullopt;
  return fit;
}

}  // namespace understudy::spu
