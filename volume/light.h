// SPDX-License-Identifier: Apache-2.0
// A directional light, after Blinn and Phong. A point of premultiplied colour c and opacity a shows
//
//     (ambient + diffuse |n . l|) c + specular |n . h|^shininess a,   h = (l + e) / |l + e|
//
// with l the direction to the light and e that to the eye, both from the point. The normal n is the direction
// in which the field falls fastest: its gradient is taken by central differences of the linearly filtered
// field, `reach` texels to both sides of the point on each axis. (Beyond the texture the filter's wrapping
// holds; on an axis that repeats, what is looked at stays within half a texel of the texture.) Points without a
// gradient, because the field is even or not a number around them, show `even` c. A gradient that is all but
// nothing has a direction made of rounding: below `full_slope` what is lit fades into that colour, as
//
//     s lit + (1 - s) even c,   s = |gradient| / full_slope
//
// Programs that keep their normals from a division by zero make them shorter where gradients g are small
// (`guard`): n . l and n . h are cosines times
//
//     |g| / (|g| + e)   or   |g| / sqrt(|g|^2 + e^2)   or   |g| / max(|g|, e)
//
// Shading of another kind, with light that shines from the eye, is a function of the cosine between normal and
// ray (shortened likewise) alone: `response` holds it, point by point, in place of |n . l| and |n .
// h|^shininess.
//
// Gradient opacity (Levoy 1988) is of a point's slope alone: colour and opacity are multiplied by a number that
// `gradient_opacity` has for |gradient|, 0 where there is no gradient.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace understudy::volume {

/// What stands for |n . l| and for |n . h|^shininess.
struct LightResponse {
  float diffuse = 0;
  float specular = 0;
  bool operator==(const LightResponse&) const = default;
};

constexpr std::size_t max_light_responses = 4096;

/// What keeps normals from a division by zero.
struct NormalGuard {
  enum class Form : std::uint8_t { added, root_of_squares, larger };
  /// e, in values, normalised as those of a TransferFunction, per unit of length of a light's `space`; 0:
  /// normals have length 1.
  double slope = 0;
  Form form = Form::added;

  /// Of a normal where the field has this slope, which is positive.
  double length_of_normal(double of_gradient) const {
    if (slope == 0) return 1;
    if (form == Form::added) return of_gradient / (of_gradient + slope);
    if (form == Form::larger) return of_gradient / std::max(of_gradient, slope);
    return of_gradient / std::sqrt(of_gradient * of_gradient + slope * slope);
  }
  bool operator==(const NormalGuard&) const = default;
};

constexpr std::size_t max_gradient_opacities = 16384;

/// What points are multiplied by: `factors` stand for evenly spaced slopes, from `first` to `last`, are
/// interpolated linearly in between and hold beyond.
struct GradientOpacity {
  std::vector<float> factors;  ///< at least two, from 0 to 1; empty: none
  /// In values, normalised as those of a TransferFunction, per unit of length of a light's `space`.
  double first = 0;
  double last = 1;

  double at(double slope) const {
    const double end = double(factors.size() - 1);
    const double place = std::clamp((slope - first) / (last - first) * end, 0.0, end);
    const std::size_t entry = std::min(std::size_t(place), factors.size() - 2);
    const double share = place - double(entry);
    return double(factors[entry]) + share * (double(factors[entry + 1]) - double(factors[entry]));
  }
  bool operator==(const GradientOpacity&) const = default;
};

/// The default is understudy render's --material.
struct Light {
  /// Row-major; texture space to the space in which directions are meant and angles are measured.
  std::array<double, 9> space{1, 0, 0, 0, 1, 0, 0, 0, 1};
  /// What takes rays there instead, where a program compares gradients of one space with rays of another
  /// (gradients per texel, and rays in texture space); null: `space`.
  std::optional<std::array<double, 9>> ray_space{};
  /// To the light, of any length; zero: it shines from the eye, along every ray.
  std::array<double, 3> direction{};
  std::array<float, 3> ambient{0.2F, 0.2F, 0.2F};
  std::array<float, 3> diffuse{0.8F, 0.8F, 0.8F};
  std::array<float, 3> specular{0.3F, 0.3F, 0.3F};
  float shininess = 20;
  /// In values, normalised as those of a TransferFunction, per unit of length of `space`; 0: nothing fades.
  float full_slope = 0;
  NormalGuard guard{};
  /// False: where n . l is negative the point lies in its own shadow, and where n . h is it does not gleam.
  bool two_sided = true;
  /// False: surfaces alone are lit; what the transfer function shows keeps its colour.
  bool on_samples = true;
  std::array<double, 3> reach{1, 1, 1};
  /// So much of their colour do points without a gradient keep.
  std::array<float, 3> even{1, 1, 1};
  /// No more than so many times its opacity does a lit point show in any channel: programs clamp colours.
  float brightest = std::numeric_limits<float>::infinity();
  /// If not empty: at cosines from -1 to 1, evenly spaced; interpolated linearly in between. `direction` is
  /// zero, `shininess` and `two_sided` are not looked at.
  std::vector<LightResponse> response;
  GradientOpacity gradient_opacity;  ///< of samples alone: without surfaces and segments

  bool operator==(const Light&) const = default;
};

}  // namespace understudy::volume
