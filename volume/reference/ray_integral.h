// SPDX-License-Identifier: Apache-2.0
// Integrals along a ray through a field, in double precision and without a step size: the volume rendering
// integral, extremes and sum for the other operators, and the first hit of an iso-surface.
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
  /// -log of the transmittance: represents tiny opacities. Infinite behind something opaque.
  double optical_depth = 0;
  /// Estimated error of colour and transmittance, by the quadrature.
  double error = 0;

  double opacity() const;
};

/// Integrates over the stretches of a scalar field, front to back. Every stretch is split at the field's
/// extrema and where it crosses a control point of the medium; the remaining pieces are smooth, and are
/// integrated by Gauss-Legendre quadrature of order 16, bisected until halves and whole agree to `tolerance`.
/// Where the medium's opacity has a step that the field only touches, the position is accurate to the square
/// root of the machine precision.
RayIntegral ray_integral(std::span<const Stretch> ray, const Medium& medium, double tolerance = 1e-13);

/// The same for texels that are colours; a fragment is the colour of a layer of thickness `distance`.
RayIntegral ray_integral(std::span<const Stretch> ray, const LinearMap& map, double distance,
                         double tolerance = 1e-13);

/// Greatest (or least) premultiplied colour and opacity of a sample anywhere on the ray, by component. Empty if
/// there are no stretches.
std::optional<std::array<double, 4>> ray_extreme(std::span<const Stretch> ray, const Medium& medium,
                                                 bool greatest);

/// The integral of the medium's entries over the length: the limit of a sum of samples times their distance.
std::array<double, 4> ray_sum(std::span<const Stretch> ray, const Medium& medium);

/// The first position along the ray, in its unit of length, at which the field is `value`.
std::optional<double> first_hit(std::span<const Stretch> ray, double value);

}  // namespace understudy::volume
