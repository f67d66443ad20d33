// SPDX-License-Identifier: Apache-2.0
// What a ray through a field shows, in double precision and without a step size: the volume rendering integral,
// the extremes and the sum that other operators mean, and the first hit of an iso-surface.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "volume/classification.h"
#include "volume/reference/field_along_ray.h"
#include "volume/reference/medium.h"

namespace understudy::volume {

struct RayIntegral {
  std::array<double, 3> colour{};
  /// -log of the transmittance: keeps opacities far below the precision of 1. Infinite behind something opaque.
  double optical_depth = 0;
  /// How much colour and transmittance may be wrong, as far as the quadrature can tell.
  double error = 0;

  double opacity() const;
};

/// The integral over the stretches of a scalar field, front to back. Every stretch is split where the field
/// turns and where it crosses a control point of the medium; what is left is smooth, and is integrated by
/// Gauss-Legendre quadrature of order 16, bisected until halves and whole agree to `tolerance`. Where the
/// medium's opacity has a step and the field only touches it, the place is known to the square root of the
/// machine precision.
RayIntegral ray_integral(std::span<const Stretch> ray, const Medium& medium, double tolerance = 1e-13);

/// The same for colours in the texels; a fragment is the colour of a layer as thick as `distance`.
RayIntegral ray_integral(std::span<const Stretch> ray, const LinearMap& map, double distance,
                         double tolerance = 1e-13);

/// Greatest (or least) premultiplied colour and opacity of a sample anywhere on the ray, by component. Empty
/// without stretches.
std::optional<std::array<double, 4>> ray_extreme(std::span<const Stretch> ray, const Medium& medium,
                                                 bool greatest);

/// The integral of the medium's entries over the length: what a sum of samples, times their distance, tends to.
std::array<double, 4> ray_sum(std::span<const Stretch> ray, const Medium& medium);

/// Where along the ray, in its unit of length, the field first is `value`.
std::optional<double> first_hit(std::span<const Stretch> ray, double value);

}  // namespace understudy::volume
