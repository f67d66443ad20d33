// SPDX-License-Identifier: Apache-2.0
// A directional light, after Blinn and Phong. A point of premultiplied colour c and opacity a shows
//
//     (ambient + diffuse |n . l|) c + specular |n . h|^shininess a,   h = (l + e) / |l + e|
//
// where l is the direction from the point to the light and e the direction to the eye. The normal n is the
// direction in which the field decreases fastest: its negated gradient, from central differences of the
// linearly filtered field, `reach` texels to both sides of the point on each axis. (Beyond the texture, its
// wrapping applies; on a repeating axis, sampled positions stay within half a texel of the texture.) A point
// without a gradient, because the field around it is constant or NaN, shows `even` c. The direction of a nearly
// zero gradient is rounding noise; below `full_slope` the lit colour therefore fades into that colour, as
//
//     s lit + (1 - s) even c,   s = |gradient| / full_slope
//
// Programs that protect the normalisation from a division by zero shorten normals where the gradient g is small
// (`guard`): n . l and n . h are cosines times
//
//     |g| / (|g| + e)   or   |g| / sqrt(|g|^2 + e^2)   or   |g| / max(|g|, e)
//
// Other shading models with a headlight depend only on the cosine between normal and ray (shortened likewise):
// `response` tabulates them and replaces |n . l| and |n . h|^shininess.
//
// Gradient opacity (Levoy 1988) depends only on |gradient|: colour and opacity are multiplied by the factor
// that `gradient_opacity` has for it, 0 where there is no gradient.
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

/// Replaces |n . l| and |n . h|^shininess.
struct LightResponse {
  float diffuse = 0;
  float specular = 0;
  bool operator==(const LightResponse&) const = default;
};

constexpr std::size_t max_light_responses = 4096;

/// Protects normals from a division by zero.
struct NormalGuard {
  enum class Form : std::uint8_t { added, root_of_squares, larger };
  /// e, in normalised values as of a TransferFunction, per unit of length of the light's `space`; 0: normals
  /// have length 1.
  double slope = 0;
  Form form = Form::added;

  /// Length of the normal where the gradient has this length, which is positive.
  double length_of_normal(double of_gradient) const {
    if (slope == 0) return 1;
    if (form == Form::added) return of_gradient / (of_gradient + slope);
    if (form == Form::larger) return of_gradient / std::max(of_gradient, slope);
    return of_gradient / std::sqrt(of_gradient * of_gradient + slope * slope);
  }
  bool operator==(const NormalGuard&) const = default;
};

constexpr std::size_t max_gradient_opacities = 16384;

/// Factors that colour and opacity are multiplied by: `factors` belong to evenly spaced gradient lengths from
/// `first` to `last`; linear in between and constant beyond.
struct GradientOpacity {
  std::vector<float> factors;  ///< at least two, from 0 to 1; empty: none
  /// In normalised values, as of a TransferFunction, per unit of length of the light's `space`.
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
  /// Row-major; from texture space to the space in which directions are given and angles are measured.
  std::array<double, 9> space{1, 0, 0, 0, 1, 0, 0, 0, 1};
  /// Maps rays to that space instead, for programs that combine gradients of one space with rays of another
  /// (gradients per texel, rays in texture space); unset: `space`.
  std::optional<std::array<double, 9>> ray_space{};
  /// Towards the light, of any length; zero: a headlight, which shines from the eye along every ray.
  std::array<double, 3> direction{};
  std::array<float, 3> ambient{0.2F, 0.2F, 0.2F};
  std::array<float, 3> diffuse{0.8F, 0.8F, 0.8F};
  std::array<float, 3> specular{0.3F, 0.3F, 0.3F};
  float shininess = 20;
  /// In normalised values, as of a TransferFunction, per unit of length of `space`; 0: no fading.
  float full_slope = 0;
  NormalGuard guard{};
  /// False: points with negative n . l get no diffuse light, and those with negative n . h no highlight.
  bool two_sided = true;
  /// False: only surfaces are lit; samples keep the colour of the transfer function.
  bool on_samples = true;
  std::array<double, 3> reach{1, 1, 1};
  /// The part of its colour, by channel, that a point without a gradient keeps.
  std::array<float, 3> even{1, 1, 1};
  /// A lit point shows at most this times its opacity in any channel: programs clamp colours.
  float brightest = std::numeric_limits<float>::infinity();
  /// If not empty: responses at evenly spaced cosines from -1 to 1; linear in between. `direction` must be
  /// zero; `shininess` and `two_sided` are ignored.
  std::vector<LightResponse> response;
  GradientOpacity gradient_opacity;  ///< of samples only; not with surfaces or segments

  bool operator==(const Light&) const = default;
};

}  // namespace understudy::volume
