// SPDX-License-Identifier: Apache-2.0
#include "volume/reference/ray_integral.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace understudy::volume {
namespace {

constexpr std::size_t order = 8;  // nodes; exact for polynomials of degree 15

/// Gauss-Legendre nodes on [0, 1], and integrals of the polynomial through the nodes from 0 to each of them.
struct Quadrature {
  std::array<double, order> node{};
  std::array<double, order> weight{};
  std::array<std::array<double, order>, order> up_to{};

  Quadrature();
};

using Legendre = std::array<double, order + 1>;

/// The Legendre polynomials of degrees 0 to `order` at x.
Legendre legendre(double x) {
  Legendre p{1, x};
  for (std::size_t k = 1; k < order; ++k)
    p[k + 1] = (double(2 * k + 1) * x * p[k] - double(k) * p[k - 1]) / double(k + 1);
  return p;
}

Quadrature::Quadrature() {
  std::array<double, order> x{};
  std::array<Legendre, order> p{};
  for (std::size_t i = 0; i < order; ++i) {
    double root = -std::cos(std::numbers::pi * (double(i) + 0.75) / (double(order) + 0.5));
    double slope = 0;
    for (int iteration = 0; iteration < 20; ++iteration) {
      const Legendre at = legendre(root);
      slope = double(order) * (root * at[order] - at[order - 1]) / (root * root - 1);
      root -= at[order] / slope;
    }
    x[i] = root;
    p[i] = legendre(root);
    node[i] = 0.5 * (root + 1);
    weight[i] = 1 / ((1 - root * root) * slope * slope);
  }
  // The Lagrange polynomial of node j is the sum over k of (2k + 1) / 2 w_j P_k(x_j) P_k, and the integral of
  // P_k is (P_{k+1} - P_{k-1}) / (2k + 1).
  for (std::size_t i = 0; i < order; ++i) {
    for (std::size_t j = 0; j < order; ++j) {
      double sum = x[i] + 1;
      for (std::size_t k = 1; k < order; ++k) sum += p[j][k] * (p[i][k + 1] - p[i][k - 1]);
      up_to[i][j] = 0.5 * weight[j] * sum;
    }
  }
}

const Quadrature& quadrature() {
  static const Quadrature rule;
  return rule;
}

/// The contribution of a piece of the ray, without attenuation in front of it.
struct Panel {
  std::array<double, 3> colour{};
  double depth = 0;
};

/// Integrates `rate(u)` over u in [a, b], where u = 1 corresponds to `length`.
template <typename RateAt>
Panel panel(const RateAt& rate, double a, double b, double length) {
  const Quadrature& rule = quadrature();
  std::array<Rate, order> at;
  const double scale = (b - a) * length;
  for (std::size_t i = 0; i < order; ++i) at[i] = rate(a + (b - a) * rule.node[i]);
  Panel sum;
  for (std::size_t i = 0; i < order; ++i) {
    double before = 0;
    for (std::size_t j = 0; j < order; ++j) before += rule.up_to[i][j] * at[j].extinction;
    const double weight = rule.weight[i] * scale * std::exp(-before * scale);
    for (std::size_t k = 0; k < 3; ++k) sum.colour[k] += weight * at[i].source[k];
    sum.depth += rule.weight[i] * scale * at[i].extinction;
  }
  return sum;
}

double greatest_difference(const Panel& a, const Panel& b) {
  double difference = std::abs(std::exp(-a.depth) - std::exp(-b.depth));
  for (std::size_t k = 0; k < 3; ++k) difference = std::max(difference, std::abs(a.colour[k] - b.colour[k]));
  return difference;
}

class Integrator {
 public:
  explicit Integrator(double tolerance)
      : tolerance_(tolerance), darkest_(tolerance > 1e-12 ? 7 - std::log(tolerance) : 745) {}

  /// Nothing behind is visible: transmittance is below a thousandth of the tolerance, or the smallest double.
  bool dark() const { return sum_.optical_depth > darkest_; }
  RayIntegral sum() const { return sum_; }

  void add_opaque(const std::array<double, 3>& colour) {
    add({colour, std::numeric_limits<double>::infinity()});
  }

  /// `noise`: rounding error of extinctions.
  template <typename RateAt>
  void add(const RateAt& rate, double a, double b, double length, double noise) {
    if (dark()) return;
    noise_ = noise * length;
    split(rate, a, b, length, panel(rate, a, b, length));
  }

 private:
  /// Above this depth, one panel does not resolve the exponential, and halves and whole may agree although both
  /// are wrong.
  static constexpr double deepest_panel = 4;

  void add(const Panel& piece) {
    const double light = std::exp(-sum_.optical_depth);
    for (std::size_t k = 0; k < 3; ++k) sum_.colour[k] += light * piece.colour[k];
    sum_.optical_depth += piece.depth;
  }

  template <typename RateAt>
  void split(const RateAt& rate, double a, double b, double length, const Panel& whole) {
    if (dark()) return;
    const double middle = 0.5 * (a + b);
    if (!(a < middle && middle < b)) {
      // No double lies between: the extinction is so large that this is a surface.
      const Rate at = rate(a);
      const double seen = -std::expm1(-whole.depth) / at.extinction;
      add({{at.source[0] * seen, at.source[1] * seen, at.source[2] * seen}, whole.depth});
      return;
    }
    const Panel first = panel(rate, a, middle, length);
    const Panel second = panel(rate, middle, b, length);
    Panel both = first;
    const double dimmed = std::exp(-first.depth);
    for (std::size_t k = 0; k < 3; ++k) both.colour[k] += dimmed * second.colour[k];
    both.depth += second.depth;
    const double light = std::exp(-sum_.optical_depth);
    const double difference = light * greatest_difference(both, whole);
    // For thin fog: an opacity of 1e-9 must have the same relative accuracy as one of 1.
    const bool same_depth = std::abs(both.depth - whole.depth) <= tolerance_ * both.depth + noise_ * (b - a);
    if (both.depth < deepest_panel && difference <= tolerance_ && same_depth) {
      add(both);
      sum_.error += difference;
      return;
    }
    split(rate, a, middle, length, first);
    split(rate, middle, b, length, second);
  }

  double tolerance_;
  double darkest_;
  double noise_ = 0;  ///< of the optical depth over a whole stretch
  RayIntegral sum_;
};

/// Calls `visit(a, b, segment)` for the parts of a stretch on which the medium is smooth, in order.
template <typename Visit>
void for_each_smooth_part(const Cubic& value, const Medium& medium, Visit visit) {
  const auto turns = monotone_parts(value);
  const auto& control_points = medium.control_points();
  for (std::size_t i = 0; i + 1 < turns.size(); ++i) {
    const double at_begin = value(turns[i]), at_end = value(turns[i + 1]);
    const double low = std::min(at_begin, at_end), high = std::max(at_begin, at_end);
    const auto first = std::upper_bound(control_points.begin(), control_points.end(), low);
    const auto last = std::lower_bound(first, control_points.end(), high);
    std::vector<double> cuts;
    // The cubic is monotone in this part, so it crosses each of these control points once.
    for (auto point = first; point < last; ++point) {
      double a = turns[i], b = turns[i + 1];
      const bool rising = at_end > at_begin;
      for (int step = 0; step < 100; ++step) {
        const double middle = 0.5 * (a + b);
        if (!(a < middle && middle < b)) break;
        ((value(middle) > *point) == rising ? b : a) = middle;
      }
      cuts.push_back(0.5 * (a + b));
    }
    if (at_end < at_begin) std::reverse(cuts.begin(), cuts.end());
    cuts.push_back(turns[i + 1]);
    double begin = turns[i];
    for (const double end : cuts) {
      if (begin < end) visit(begin, end, medium.segment_of(value(0.5 * (begin + end))));
      begin = end;
    }
  }
}

std::array<double, 4> fragment(const LinearMap& map, const Stretch& stretch, double u) {
  std::array<double, 4> texel{}, colour{};
  for (std::size_t k = 0; k < 4; ++k) texel[k] = stretch.value[k](u);
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t k = 0; k < 4; ++k) colour[row] += double(map.matrix[4 * row + k]) * texel[k];
    colour[row] = std::clamp(colour[row], 0.0, 1.0);
  }
  if (colour[3] <= double(map.alpha_above)) return {};
  if (map.multiply_by_alpha) {
    for (std::size_t k = 0; k < 3; ++k) colour[k] *= colour[3];
  }
  return colour;
}

}  // namespace

double RayIntegral::opacity() const {
  return -std::expm1(-optical_depth);
}

RayIntegral ray_integral(std::span<const Stretch> ray, const Medium& medium, double tolerance) {
  Integrator integrator(tolerance);
  for (const Stretch& stretch : ray) {
    if (integrator.dark()) break;
    const Cubic& value = stretch.value[0];
    for_each_smooth_part(value, medium, [&](double a, double b, std::size_t segment) {
      if (medium.empty(segment) || integrator.dark()) return;
      const bool constant = value(a) == value(b);
      if (constant ? medium.opaque_at(segment, value(a)) : medium.opaque(segment)) {
        const auto seen = medium.entry_at(segment, value(a));
        return integrator.add_opaque({seen[0], seen[1], seen[2]});
      }
      integrator.add([&](double u) { return medium.rate(segment, value(u)); }, a, b, stretch.length,
                     medium.noise(segment));
    });
  }
  return integrator.sum();
}

RayIntegral ray_integral(std::span<const Stretch> ray, const LinearMap& map, double distance,
                         double tolerance) {
  Integrator integrator(tolerance);
  for (const Stretch& stretch : ray) {
    const auto at = [&](double u) { return fragment(map, stretch, u); };
    const bool opaque = at(0)[3] >= 1 && at(0.5)[3] >= 1 && at(1)[3] >= 1;
    if (integrator.dark()) break;
    if (opaque) {
      const auto colour = at(0);
      integrator.add_opaque({colour[0], colour[1], colour[2]});
    } else {
      integrator.add([&](double u) { return rate_of_sample(at(u), distance); }, 0, 1, stretch.length,
                     8 * std::numeric_limits<double>::epsilon() / distance);
    }
  }
  return integrator.sum();
}

std::optional<std::array<double, 4>> ray_extreme(std::span<const Stretch> ray, const Medium& medium,
                                                 bool greatest) {
  std::optional<std::array<double, 4>> extreme;
  for (const Stretch& stretch : ray) {
    const Cubic& value = stretch.value[0];
    for_each_smooth_part(value, medium, [&](double a, double b, std::size_t segment) {
      for (const double u : {a, b}) {
        const auto entry = medium.entry_at(segment, value(u));
        if (!extreme) extreme = entry;
        for (std::size_t k = 0; k < 4; ++k)
          (*extreme)[k] = greatest ? std::max((*extreme)[k], entry[k]) : std::min((*extreme)[k], entry[k]);
      }
    });
  }
  return extreme;
}

std::array<double, 4> ray_sum(std::span<const Stretch> ray, const Medium& medium) {
  const Quadrature& rule = quadrature();
  std::array<double, 4> sum{};
  for (const Stretch& stretch : ray) {
    const Cubic& value = stretch.value[0];
    for_each_smooth_part(value, medium, [&](double a, double b, std::size_t segment) {
      for (std::size_t i = 0; i < order; ++i) {
        const auto entry = medium.entry_at(segment, value(a + (b - a) * rule.node[i]));
        for (std::size_t k = 0; k < 4; ++k) sum[k] += rule.weight[i] * (b - a) * stretch.length * entry[k];
      }
    });
  }
  return sum;
}

std::optional<double> first_hit(std::span<const Stretch> ray, double value) {
  double before = 0;
  for (const Stretch& stretch : ray) {
    if (stretch.value[0](0) == value) return before;
    if (const auto found = crossings(stretch.value[0], value); !found.empty())
      return before + found.front() * stretch.length;
    before += stretch.length;
  }
  return std::nullopt;
}

}  // namespace understudy::volume
