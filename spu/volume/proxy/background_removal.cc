// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/background_removal.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "volume/matrix.h"

namespace understudy::spu {

using volume::Rgba;
using volume::Vec3;

namespace {

/// Opacity of `samples` samples of opacity `alpha`.
double composed(double alpha, double samples) {
  return -std::expm1(samples * std::log1p(-std::min(alpha, 1.0)));
}

/// Least-squares fit of the contrast, given the opacity of one sample.
struct Fit {
  Fit(double alpha, std::span<const double> samples, std::span<const Vec3> differences) {
    double squares = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double opacity = composed(alpha, samples[i]);
      squares += opacity * opacity;
      for (std::size_t c = 0; c < 3; ++c) full[c] += opacity * differences[i][c];
    }
    for (double& channel : full) channel /= squares;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double opacity = composed(alpha, samples[i]);
      for (std::size_t c = 0; c < 3; ++c) {
        const double off = differences[i][c] - opacity * full[c];
        residual += off * off;
      }
    }
  }

  Vec3 full{};
  double residual = 0;
};

/// Returns the opacity of one sample, 1e-6 to 1, that fits best. Searches on a logarithmic scale, first in
/// equal steps, then by golden section.
double best_alpha(std::span<const double> samples, std::span<const Vec3> differences) {
  constexpr double lowest = -6;
  constexpr int steps = 48;
  constexpr double step = -lowest / steps;
  constexpr double golden_section = 0.618033988749895;
  const auto residual = [&](double exponent) {
    return Fit(std::pow(10.0, exponent), samples, differences).residual;
  };
  double best = 0;
  double least = residual(0);
  for (int i = 1; i <= steps; ++i) {
    const double off = residual(-i * step);
    if (off >= least) continue;
    least = off;
    best = -i * step;
  }
  double low = std::max(lowest, best - step);
  double high = std::min(0.0, best + step);
  for (int i = 0; i < 40; ++i) {
    const double left = high - golden_section * (high - low);
    const double right = low + golden_section * (high - low);
    if (residual(left) <= residual(right)) {
      high = right;
    } else {
      low = left;
    }
  }
  const double refined = (low + high) / 2;
  return std::pow(10.0, residual(refined) <= least ? refined : best);
}

}  // namespace

Vec3 colour_of(const Rgba& rgba) {
  return {rgba[0], rgba[1], rgba[2]};
}

BackgroundContrast contrast_of(std::span<const double> samples, std::span<const Vec3> differences) {
  constexpr double nothing = 2e-5;  // rounding error of sums of float colours
  constexpr std::size_t fewest = 3;
  constexpr double opaque = 0.6;
  const bool shows = std::ranges::any_of(differences, [&](const Vec3& difference) {
    return std::sqrt(volume::dot(difference, difference)) > nothing;
  });
  if (!shows) return {};
  std::size_t count = std::min(fewest, samples.size());
  double alpha = best_alpha(samples.first(count), differences.first(count));
  while (count < samples.size() && composed(alpha, samples[count]) < opaque) {
    ++count;
    alpha = best_alpha(samples.first(count), differences.first(count));
  }
  return {Fit(alpha, samples.first(count), differences.first(count)).full, alpha};
}

double opacity_of(const BackgroundContrast& contrast, const Vec3& difference) {
  if (!contrast.visible()) return 0;
  return std::clamp(volume::dot(difference, contrast.full) / volume::dot(contrast.full, contrast.full), 0.0,
                    1.0);
}

std::optional<double> opacity_of(const BackgroundContrast& one, const BackgroundContrast& other,
                                 const Vec3& difference) {
  constexpr double least_squared_sine = 0.04;
  if (!one.visible()) return opacity_of(other, difference);
  if (!other.visible()) return opacity_of(one, difference);
  const double of_one = volume::dot(one.full, one.full);
  const double of_other = volume::dot(other.full, other.full);
  const double common = volume::dot(one.full, other.full);
  const double determinant = of_one * of_other - common * common;
  if (determinant < least_squared_sine * of_one * of_other) return std::nullopt;
  const double along_one = volume::dot(difference, one.full);
  const double along_other = volume::dot(difference, other.full);
  // The opacities add up: that of the near samples, and that of the far ones as seen through the near ones.
  const double near = (along_one * of_other - along_other * common) / determinant;
  const double far = (along_other * of_one - along_one * common) / determinant;
  return std::clamp(near + far, 0.0, 1.0);
}

Rgba without_background(const ShaderBackground& background, double opacity, const Rgba& fragment) {
  const Vec3 difference = volume::subtract(colour_of(fragment), background.colour);
  Rgba ray{};
  for (std::size_t c = 0; c < 3 && opacity > 0; ++c)
    ray[c] = float(std::max(0.0, difference[c] + opacity * background.colour[c]));
  ray[3] = float(opacity);
  return ray;
}

Rgba over_background(const ShaderBackground& background, const Rgba& ray) {
  Rgba fragment{0, 0, 0, background.alpha};
  for (std::size_t c = 0; c < 3; ++c) fragment[c] = float(ray[c] + (1 - double(ray[3])) * background.colour[c]);
  return fragment;
}

}  // namespace understudy::spu
