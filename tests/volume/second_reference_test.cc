// SPDX-License-Identifier: Apache-2.0
// Compares the double-precision reference with a second one that shares no code with it: rays, field, transfer
// function and integral are implemented separately in long double, and the integral is computed by bisection
// alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <random>
#include <vector>

#include "tests/volume/fields.h"
#include "volume/orbit_camera.h"
#include "volume/reference/pixel_integral.h"
#include "volume/request.h"

namespace understudy::volume::testing {
namespace {

using Real = long double;
using Point = std::array<Real, 3>;

/// A cube of 32-bit float texels; outside, the nearest texel is repeated.
struct Grid {
  std::array<int, 3> size{};
  std::vector<float> values;

  Real texel(int x, int y, int z) const {
    x = std::clamp(x, 0, size[0] - 1);
    y = std::clamp(y, 0, size[1] - 1);
    z = std::clamp(z, 0, size[2] - 1);
    return Real(values[(std::size_t(z) * std::size_t(size[1]) + std::size_t(y)) * std::size_t(size[0]) +
                       std::size_t(x)]);
  }

  Real at(const Point& p) const {
    std::array<int, 3> low{};
    Point part{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Real place = p[k] * Real(size[k]) - Real(0.5);
      low[k] = int(std::floor(place));
      part[k] = place - Real(low[k]);
    }
    Real sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const int i = corner & 1, j = corner >> 1 & 1, k = corner >> 2;
      const Real weight =
          (i ? part[0] : 1 - part[0]) * (j ? part[1] : 1 - part[1]) * (k ? part[2] : 1 - part[2]);
      sum += weight * texel(low[0] + i, low[1] + j, low[2] + k);
    }
    return sum;
  }
};

/// Rates per unit length, from premultiplied entries over [0, 1].
struct Rates {
  Real extinction = 0;
  std::array<Real, 3> source{};
};

Rates rates_at(const std::vector<Rgba>& entries, Real value) {
  const Real place = std::clamp(value, Real(0), Real(1)) * Real(entries.size() - 1);
  const auto below = std::min(std::size_t(place), entries.size() - 2);
  std::array<Real, 4> entry{};
  for (std::size_t k = 0; k < 4; ++k)
    entry[k] = Real(entries[below][k]) +
               (place - Real(below)) * (Real(entries[below + 1][k]) - Real(entries[below][k]));
  Rates rates;
  rates.extinction = -std::log1p(-entry[3]);
  for (std::size_t k = 0; k < 3; ++k)
    rates.source[k] = entry[3] > 0 ? entry[k] * rates.extinction / entry[3] : entry[k];
  return rates;
}

/// Colour and opacity of a part of a ray.
struct Shown {
  std::array<Real, 3> colour{};
  Real opacity = 0;

  Shown before(const Shown& behind) const {
    Shown both;
    for (std::size_t k = 0; k < 3; ++k) both.colour[k] = colour[k] + (1 - opacity) * behind.colour[k];
    both.opacity = opacity + (1 - opacity) * behind.opacity;
    return both;
  }
  Real far_from(const Shown& other) const {
    Real most = std::abs(opacity - other.opacity);
    for (std::size_t k = 0; k < 3; ++k) most = std::max(most, std::abs(colour[k] - other.colour[k]));
    return most;
  }
};

class Integral {
 public:
  Integral(const Grid& grid, const std::vector<Rgba>& entries, Point from, Point to, Real length)
      : grid_(grid), entries_(entries), from_(from), to_(to), length_(length) {}

  /// Integral between the ray parameters a and b, in [0, 1].
  Shown between(Real a, Real b, int depth = 0) const {
    const Real middle = (a + b) / 2;
    const Shown whole = layer(a, b);
    const Shown halves = layer(a, middle).before(layer(middle, b));
    constexpr int least = 9, most = 34;
    if (depth >= most || (depth >= least && halves.far_from(whole) < Real(1e-8) * (b - a))) {
      // On halves, the midpoint rule has a quarter of the error.
      Shown better = halves;
      for (std::size_t k = 0; k < 3; ++k) better.colour[k] += (halves.colour[k] - whole.colour[k]) / 3;
      better.opacity += (halves.opacity - whole.opacity) / 3;
      return better;
    }
    return between(a, middle, depth + 1).before(between(middle, b, depth + 1));
  }

 private:
  Shown layer(Real a, Real b) const {
    Point p{};
    for (std::size_t k = 0; k < 3; ++k) p[k] = from_[k] + (a + b) / 2 * (to_[k] - from_[k]);
    const Rates rates = rates_at(entries_, grid_.at(p));
    const Real way = (b - a) * length_, depth = rates.extinction * way;
    Shown shown;
    shown.opacity = -std::expm1(-depth);
    for (std::size_t k = 0; k < 3; ++k)
      shown.colour[k] = rates.source[k] * (depth > 0 ? shown.opacity / rates.extinction : way);
    return shown;
  }

  const Grid& grid_;
  const std::vector<Rgba>& entries_;
  Point from_, to_;
  Real length_;
};

/// Solves a 4 x 4 system by elimination.
std::array<Real, 4> solved(std::array<std::array<Real, 5>, 4> rows) {
  for (std::size_t c = 0; c < 4; ++c) {
    std::size_t pivot = c;
    for (std::size_t r = c; r < 4; ++r)
      if (std::abs(rows[r][c]) > std::abs(rows[pivot][c])) pivot = r;
    std::swap(rows[c], rows[pivot]);
    for (std::size_t r = 0; r < 4; ++r) {
      if (r == c) continue;
      const Real factor = rows[r][c] / rows[c][c];
      for (std::size_t k = c; k < 5; ++k) rows[r][k] -= factor * rows[c][k];
    }
  }
  return {rows[0][4] / rows[0][0], rows[1][4] / rows[1][1], rows[2][4] / rows[2][2], rows[3][4] / rows[3][3]};
}

/// The point in texture space at the given depth behind a pixel centre.
Point behind_pixel(const RenderRequest& request, int x, int y, Real depth) {
  const Real across = 2 * (x + Real(0.5)) / request.viewport.width - 1;
  const Real up = 2 * (y + Real(0.5)) / request.viewport.height - 1;
  std::array<std::array<Real, 5>, 4> rows{};
  const std::array<Real, 4> clip{across, up, depth, 1};
  for (std::size_t r = 0; r < 4; ++r) {
    for (std::size_t c = 0; c < 4; ++c) rows[r][c] = Real(request.texture_to_clip[4 * r + c]);
    rows[r][4] = clip[r];
  }
  const auto p = solved(rows);
  return {p[0] / p[3], p[1] / p[3], p[2] / p[3]};
}

/// The part of the ray inside the unit cube.
std::optional<std::array<Point, 2>> ray_in_cube(const RenderRequest& request, int x, int y) {
  const Point near = behind_pixel(request, x, y, -1), far = behind_pixel(request, x, y, 1);
  Real enter = 0, leave = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    Real a = -near[k] / (far[k] - near[k]), b = (1 - near[k]) / (far[k] - near[k]);
    if (a > b) std::swap(a, b);
    enter = std::max(enter, a);
    leave = std::min(leave, b);
  }
  if (!(enter < leave)) return std::nullopt;
  std::array<Point, 2> ends{};
  for (std::size_t k = 0; k < 3; ++k) {
    ends[0][k] = near[k] + enter * (far[k] - near[k]);
    ends[1][k] = near[k] + leave * (far[k] - near[k]);
  }
  return ends;
}

TEST(SecondReference, AgreesWithTheFirst) {
  double greatest = 0;
  int rays = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    const auto uniform = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    const std::array<int, 3> size{int(5 + random() % 6), int(5 + random() % 6), int(5 + random() % 6)};
    const Texture texture = noise(describe(size, TexelType::f32), seed);
    Grid grid{size, std::vector<float>(texture.texels.size() / sizeof(float))};
    std::memcpy(grid.values.data(), texture.texels.data(), texture.texels.size());

    TransferFunction table;
    const std::size_t entries = seed % 4 == 0 ? 2 : seed % 4 == 1 ? 9 : 33;
    const double opaque = seed % 5 == 0 ? 0.9999 : seed % 5 == 1 ? 0.5 : 0.05;
    for (std::size_t i = 0; i < entries; ++i) {
      const auto alpha = float(seed % 3 == 0 && i % 2 == 0 ? 0 : uniform(0, opaque));
      table.entries.push_back({alpha * float(uniform(0, 1)), alpha * float(uniform(0, 1)), alpha, alpha});
    }
    const OrbitCamera camera{uniform(-180, 180), uniform(-80, 80), uniform(1.2, 5)};
    const RenderRequest request = orbit_request(texture.description, {1, 1, 1}, camera, 9, 8, 1);
    const Field field = texture_field(texture.description, Filter::linear, texture.texels);
    const Medium medium = Medium::of_samples(table, 1);
    for (const auto& [x, y] : {std::array{4, 4}, {2, 5}}) {
      const auto ends = ray_in_cube(request, x, y);
      const auto exact = pixel_integral(field, size, request, medium, x, y);
      if (!ends) {
        EXPECT_EQ(exact[3], 0);
        continue;
      }
      Real square = 0;
      for (std::size_t k = 0; k < 3; ++k)
        square += std::pow(((*ends)[1][k] - (*ends)[0][k]) * Real(size[k]), Real(2));  // in voxels
      const Shown shown =
          Integral(grid, table.entries, (*ends)[0], (*ends)[1], std::sqrt(square)).between(0, 1);
      for (std::size_t k = 0; k < 3; ++k)
        greatest = std::max(greatest, std::abs(double(shown.colour[k]) - exact[k]));
      greatest = std::max(greatest, std::abs(double(shown.opacity) - exact[3]));
      ++rays;
    }
  }
  std::printf("%d rays of 20 scenes: the two differ by at most %.1e\n", rays, greatest);
  EXPECT_GT(rays, 30);
  EXPECT_LE(greatest, 5e-6);
}

}  // namespace
}  // namespace understudy::volume::testing
