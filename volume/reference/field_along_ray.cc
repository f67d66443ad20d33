// SPDX-License-Identifier: Apache-2.0
#include "volume/reference/field_along_ray.h"

#include <algorithm>
#include <cmath>

#include "volume/matrix.h"

namespace understudy::volume {
namespace {

/// The root of a monotone cubic minus `value` in [a, b], to the last bit that bisection can resolve. Newton
/// steps are taken where they stay inside.
double root_between(const Cubic& cubic, double value, double a, double b) {
  const bool rising = cubic(b) > cubic(a);
  double u = 0.5 * (a + b);
  for (int i = 0; i < 200 && a < b; ++i) {
    const double error = cubic(u) - value;
    if (error == 0) return u;
    ((error > 0) == rising ? b : a) = u;
    const double slope = cubic.c[1] + u * (2 * cubic.c[2] + u * 3 * cubic.c[3]);
    double next = u - error / slope;
    if (!(next > a && next < b)) next = 0.5 * (a + b);
    if (next == u || next <= a || next >= b) return next;
    u = next;
  }
  return u;
}

}  // namespace

Cubic cubic_through(const std::array<double, 4>& v) {
  // Newton's divided differences, expanded.
  return {{v[0], (-11 * v[0] + 18 * v[1] - 9 * v[2] + 2 * v[3]) / 2,
           9 * (2 * v[0] - 5 * v[1] + 4 * v[2] - v[3]) / 2, 9 * (-v[0] + 3 * v[1] - 3 * v[2] + v[3]) / 2}};
}

std::vector<double> monotone_parts(const Cubic& cubic) {
  std::vector<double> parts{0};
  // Roots of 3 c3 u^2 + 2 c2 u + c1, in the form without cancellation.
  const double a = 3 * cubic.c[3], half_b = cubic.c[2], c = cubic.c[1];
  const double discriminant = half_b * half_b - a * c;
  if (discriminant > 0) {
    const double q = -(half_b + std::copysign(std::sqrt(discriminant), half_b));
    std::array<double, 2> roots{q / a, c / q};
    std::sort(roots.begin(), roots.end());
    for (const double root : roots) {
      if (root > parts.back() && root < 1) parts.push_back(root);
    }
  }
  parts.push_back(1);
  return parts;
}

std::vector<double> crossings(const Cubic& cubic, double value) {
  std::vector<double> found;
  const auto parts = monotone_parts(cubic);
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
    const double at_begin = cubic(parts[i]) - value, at_end = cubic(parts[i + 1]) - value;
    if ((at_begin < 0) != (at_end < 0)) found.push_back(root_between(cubic, value, parts[i], parts[i + 1]));
  }
  return found;
}

std::array<int, 2> faces_between(double a, double b, int size) {
  // In this order, std::max and std::min replace NaN.
  const double low = std::max(-1.0, std::ceil(std::min(a, b)));
  const double high = std::min(double(size), std::floor(std::max(a, b)));
  if (low > high) return {0, -1};
  return {int(low), int(high)};
}

std::vector<Stretch> field_along_ray(const Field& field, const std::array<int, 3>& size, const Vec3& from,
                                     const Vec3& to, double length) {
  std::vector<double> cuts{0, 1};
  const Vec3 way = subtract(to, from);
  for (std::size_t k = 0; k < 3; ++k) {
    if (way[k] == 0) continue;
    const double a = from[k] * size[k] - 0.5, b = to[k] * size[k] - 0.5;
    const auto [first, last] = faces_between(a, b, size[k]);
    for (int face = first; face <= last; ++face) {
      const double s = ((double(face) + 0.5) / size[k] - from[k]) / way[k];
      if (s > 0 && s < 1) cuts.push_back(s);
    }
  }
  std::sort(cuts.begin(), cuts.end());
  std::vector<Stretch> stretches;
  stretches.reserve(cuts.size());
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double begin = cuts[i], width = cuts[i + 1] - begin;
    if (!(width > 0)) continue;
    Stretch stretch;
    stretch.length = width * length;
    std::array<std::array<double, 4>, 4> values{};  // by component
    bool known = true;
    for (std::size_t p = 0; p < 4; ++p) {
      const double s = p == 3 ? cuts[i + 1] : begin + width * (double(p) / 3);
      const auto sample = field(add(from, scale(way, s)));
      for (std::size_t k = 0; k < 4; ++k) {
        known = known && !std::isnan(sample[k]);
        values[k][p] = sample[k];
      }
    }
    if (!known) continue;
    for (std::size_t k = 0; k < 4; ++k) stretch.value[k] = cubic_through(values[k]);
    stretches.push_back(stretch);
  }
  return stretches;
}

}  // namespace understudy::volume
