// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/step_fit.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>

#include "volume/matrix.h"

namespace understudy::spu {
namespace {

using volume::Vec3;

/// The six products that a quadratic form is linear in.
std::array<double, 6> products(const Vec3& d) {
  return {d[0] * d[0], d[1] * d[1], d[2] * d[2], 2 * d[0] * d[1], 2 * d[0] * d[2], 2 * d[1] * d[2]};
}

/// Gaussian elimination with pivoting; null if singular. Unknowns are scaled by the diagonal first.
template <std::size_t N>
std::optional<std::array<double, N>> solved(std::array<std::array<double, N + 1>, N> m) {
  std::array<double, N> unit{};
  for (std::size_t i = 0; i < N; ++i) {
    if (!(m[i][i] > 0)) return std::nullopt;
    unit[i] = std::sqrt(m[i][i]);
  }
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j < N; ++j) m[i][j] /= unit[i] * unit[j];
    m[i][N] /= unit[i];
  }
  for (std::size_t i = 0; i < N; ++i) {
    std::size_t pivot = i;
    for (std::size_t j = i + 1; j < N; ++j) {
      if (std::abs(m[j][i]) > std::abs(m[pivot][i])) pivot = j;
    }
    std::swap(m[i], m[pivot]);
    if (!(std::abs(m[i][i]) > 1e-10)) return std::nullopt;
    for (std::size_t j = 0; j < N; ++j) {
      if (j == i) continue;
      const double factor = m[j][i] / m[i][i];
      for (std::size_t k = i; k <= N; ++k) m[j][k] -= factor * m[i][k];
    }
  }
  std::array<double, N> x{};
  for (std::size_t i = 0; i < N; ++i) x[i] = m[i][N] / m[i][i] / unit[i];
  return x;
}

template <std::size_t N>
class LeastSquares {
 public:
  void add(const std::array<double, N>& row, double value, double weight) {
    for (std::size_t i = 0; i < N; ++i) {
      for (std::size_t j = 0; j < N; ++j) m_[i][j] += weight * row[i] * row[j];
      m_[i][N] += weight * row[i] * value;
    }
  }
  std::optional<std::array<double, N>> solution() const { return solved<N>(m_); }

 private:
  std::array<std::array<double, N + 1>, N> m_{};
};

double linear_form(const std::array<double, 6>& g, const std::array<double, 6>& p) {
  double sum = 0;
  for (std::size_t i = 0; i < 6; ++i) sum += g[i] * p[i];
  return sum;
}

/// Upper triangle R with R^T R = g; null when g is not positive definite.
std::optional<std::array<double, 9>> root(const std::array<double, 6>& g) {
  std::array<double, 9> r{};
  if (!(g[0] > 0)) return std::nullopt;
  r[0] = std::sqrt(g[0]);
  r[1] = g[3] / r[0];
  r[2] = g[4] / r[0];
  const double second = g[1] - r[1] * r[1];
  if (!(second > 0)) return std::nullopt;
  r[4] = std::sqrt(second);
  r[5] = (g[5] - r[1] * r[2]) / r[4];
  const double third = g[2] - r[2] * r[2] - r[5] * r[5];
  if (!(third > 0)) return std::nullopt;
  r[8] = std::sqrt(third);
  return r;
}

/// The fraction of the rays that rounding does not explain.
double unexplained_part(std::span<const CountedRay> rays, const std::array<double, 6>& g, double offset,
                        double rounding) {
  std::size_t off = 0;
  for (const CountedRay& ray : rays) {
    const double length = std::sqrt(std::max(linear_form(g, products(ray.way)), 0.0));
    off += std::abs(ray.samples - length - offset) > rounding ? 1 : 0;
  }
  return double(off) / double(rays.size());
}

std::optional<StepFit> finished(std::span<const CountedRay> rays, const std::array<double, 6>& g, double offset,
                                double rounding) {
  const auto metric = root(g);
  if (!metric) return std::nullopt;
  return StepFit{*metric, offset, unexplained_part(rays, g, offset, rounding)};
}

/// Gauss-Newton for the first N products' coefficients.
template <std::size_t N>
std::optional<StepFit> fit_products(std::span<const CountedRay> rays, double offset) {
  constexpr double rounding = 0.55;  // half a step, plus the error of the fit
  const auto row_of = [](const CountedRay& ray) {
    const auto all = products(ray.way);
    std::array<double, N> row{};
    std::copy_n(all.begin(), N, row.begin());
    return row;
  };
  LeastSquares<N> squares;
  for (const CountedRay& ray : rays) {
    const double length = std::max(ray.samples - offset, 0.5);
    squares.add(row_of(ray), length * length, 1 / (length * length));
  }
  auto solution = squares.solution();
  if (!solution) return std::nullopt;
  std::array<double, 6> g{};
  std::copy_n(solution->begin(), N, g.begin());
  for (int round = 0; round < 6; ++round) {
    LeastSquares<N> refinement;
    for (const CountedRay& ray : rays) {
      auto row = row_of(ray);
      const double length = std::sqrt(std::max(linear_form(g, products(ray.way)), 1e-9));
      for (double& x : row) x /= 2 * length;
      refinement.add(row, ray.samples - length - offset, 1);
    }
    const auto change = refinement.solution();
    if (!change) return std::nullopt;
    for (std::size_t k = 0; k < N; ++k) g[k] += (*change)[k];
  }
  return finished(rays, g, offset, rounding);
}

/// Every count allows an interval of the one unknown; the result is where most of them overlap.
std::optional<StepFit> fit_one_length(std::span<const CountedRay> rays, const Vec3& axes, double offset) {
  constexpr double rounding = 0.51;
  struct End {
    double place;
    int opens;
  };
  std::vector<End> ends;
  for (const CountedRay& ray : rays) {
    const double length = volume::length({ray.way[0] * axes[0], ray.way[1] * axes[1], ray.way[2] * axes[2]});
    if (!(length > 0)) return std::nullopt;
    ends.push_back({(ray.samples - offset - rounding) / length, 1});
    ends.push_back({(ray.samples - offset + rounding) / length, -1});
  }
  std::sort(ends.begin(), ends.end(), [](const End& a, const End& b) { return a.place < b.place; });
  int open = 0;
  int most = 0;
  double density = 0;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    open += ends[i].opens;
    if (open <= most) continue;
    most = open;
    density = (ends[i].place + ends[i + 1].place) / 2;
  }
  if (!(density > 0)) return std::nullopt;
  std::array<double, 6> g{};
  for (std::size_t k = 0; k < 3; ++k) g[k] = density * density * axes[k] * axes[k];
  return finished(rays, g, offset, rounding);
}

using Fitting = std::optional<StepFit> (*)(std::span<const CountedRay>, double);

/// Adds the fits that explain the counts, and keeps the best one.
void add_fits(const std::function<std::optional<StepFit>(double)>& fit, std::vector<StepFit>& good,
              std::optional<StepFit>& best) {
  for (const double offset : {-0.5, 0.0, 0.5}) {
    const auto found = fit(offset);
    if (!found) continue;
    const bool known = std::ranges::any_of(good, [&](const StepFit& other) {
      return other.offset == offset && alike(other.metric, found->metric);
    });
    if (found->unexplained <= most_unexplained && !known) good.push_back(*found);
    if (!best || found->unexplained < best->unexplained) best = found;
  }
}

}  // namespace

bool alike(const std::array<double, 9>& one, const std::array<double, 9>& other) {
  constexpr double same = 1e-3;
  const double most = same * std::max({one[0], one[4], one[8]});
  return std::ranges::equal(one, other, [&](double a, double b) { return std::abs(a - b) <= most; });
}

std::vector<StepFit> fit_steps(std::span<const CountedRay> rays, std::span<const Vec3> spaces) {
  constexpr std::size_t fewest = 64;
  constexpr double shortest = 2;  // samples: some programs take one on rays too short for any
  std::vector<CountedRay> counted;
  std::copy_if(rays.begin(), rays.end(), std::back_inserter(counted),
               [](const CountedRay& ray) { return ray.samples >= shortest; });
  if (counted.size() < fewest) return {};
  std::optional<StepFit> best;
  std::vector<StepFit> good;
  for (const Vec3& axes : spaces)
    add_fits([&](double offset) { return fit_one_length(counted, axes, offset); }, good, best);
  for (const Fitting fit : {&fit_products<3>, &fit_products<6>}) {
    if (good.empty()) add_fits([&](double offset) { return fit(counted, offset); }, good, best);
  }
  if (!good.empty()) return good;
  if (!best) return {};
  return {*best};
}

std::vector<double> counts_from_opacities(std::span<const double> opacities) {
  std::vector<double> depths;  // optical
  for (const double a : opacities) {
    if (!(a >= 0 && a < 1)) return {};
    depths.push_back(-std::log1p(-a));
  }
  return counts_from_amounts(depths);
}

std::vector<double> counts_from_amounts(const std::vector<double>& depths) {
  constexpr double whole = 0.1;  // how far a count may be from a whole number
  std::vector<double> sorted = depths;
  std::sort(sorted.begin(), sorted.end());
  if (sorted.empty() || !(sorted.back() > 0)) return {};
  // The smallest gap between different depths is one sample's; anything far smaller is rounding.
  const double noise = 1e-5 + 1e-5 * sorted.back();
  double one = sorted.back();
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    const double gap = sorted[i] - sorted[i - 1];
    if (gap > 10 * noise) one = std::min(one, gap);
  }
  // A first guess from one gap is improved by all depths, short ones first.
  for (const double limit : {8.0, 32.0, 128.0, 1e9}) {
    double product = 0;
    double square = 0;
    for (const double depth : sorted) {
      const double n = std::round(depth / one);
      if (n < 1 || n > limit) continue;
      product += n * depth;
      square += n * n;
    }
    if (square > 0) one = product / square;
  }
  std::vector<double> counts;
  std::size_t off = 0;
  for (const double depth : depths) {
    const double n = depth / one;
    off += std::abs(n - std::round(n)) > whole ? 1 : 0;
    counts.push_back(std::round(n));
  }
  if (off * 100 > counts.size()) return {};
  return counts;
}

std::vector<volume::RaySteps> rules_of(const StepFit& fit) {
  std::vector<volume::RaySteps> rules;
  volume::RaySteps steps;
  steps.metric = fit.metric;
  // first + i <= L: floor(L - first) + 1 samples, so the offset is 1/2 - first.
  steps.first = 0.5 - fit.offset;
  rules.push_back(steps);
  steps.divided = true;
  steps.rounding = fit.offset + 0.5;
  for (const double first : {0.0, 0.5}) {
    steps.first = first;
    rules.push_back(steps);
  }
  return rules;
}

std::vector<volume::RaySteps> rules_counting_ahead(const StepFit& fit) {
  std::vector<volume::RaySteps> rules;
  volume::RaySteps steps;
  steps.metric = fit.metric;
  steps.counted_from = 0.5 - fit.offset;
  for (const double first : {0.0, 0.5, 1.0}) {
    if (first == *steps.counted_from) continue;
    steps.first = first;
    rules.push_back(steps);
  }
  return rules;
}

double counted_from(const volume::RaySteps& steps) {
  return steps.counted_from.value_or(steps.first);
}

double steps_of_way(const volume::RaySteps& steps, const Vec3& way) {
  const auto& m = steps.metric;
  return volume::length({m[0] * way[0] + m[1] * way[1] + m[2] * way[2],
                         m[3] * way[0] + m[4] * way[1] + m[5] * way[2],
                         m[6] * way[0] + m[7] * way[1] + m[8] * way[2]});
}

double samples_of_length(const volume::RaySteps& steps, double length) {
  const double count =
      steps.divided ? std::floor(length + steps.rounding) : std::floor(length - counted_from(steps)) + 1;
  return std::max(count, steps.at_least_one ? 1.0 : 0.0);
}

std::vector<double> places_on_way(const volume::RaySteps& steps, const volume::Vec3& way) {
  const double length = steps_of_way(steps, way);
  const double samples = std::max(1.0, samples_of_length(steps, length));
  std::vector<double> places;
  places.reserve(std::size_t(samples));
  for (int i = 0; i < int(samples); ++i)
    places.push_back((steps.first + i) / (steps.divided ? samples : length));
  return places;
}

}  // namespace understudy::spu
