// SPDX-License-Identifier: Apache-2.0
// Classification: from a sample of the field to colour and opacity.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <variant>
#include <vector>

#include "volume/rgba.h"

namespace understudy::volume {

/// A transfer function: N >= 2 premultiplied RGBA entries at low + i (high - low) / (N - 1), linear between
/// entries and constant outside [low, high]. Values are normalised texel values (u8: v/255, u16: v/65535,
/// float: v). Alpha is the opacity of one sample on its slice (see SlicePlanes); colour may exceed alpha
/// (emission).
struct TransferFunction {
  float low = 0.0F;
  float high = 1.0F;
  std::vector<Rgba> entries;

  bool operator==(const TransferFunction&) const = default;
};

/// Interpolates the entries at `place`, an entry index from 0 to N - 1.
inline std::array<double, 4> entry_at(const TransferFunction& function, double place) {
  const auto below = std::min(std::size_t(place), function.entries.size() - 2);
  std::array<double, 4> entry{};
  for (std::size_t k = 0; k < 4; ++k) {
    const double a = function.entries[below][k], b = function.entries[below + 1][k];
    entry[k] = a + (place - double(below)) * (b - a);
  }
  return entry;
}

/// A medium, given by its transfer function for steps of one length. `step` is the step length of a request in
/// units of that length; the request's transfer function is `function` corrected for it (opacity_correction.h).
struct MediumFunction {
  TransferFunction function;
  double step = 1;

  bool operator==(const MediumFunction&) const = default;
};

/// For volumes whose texels are colours: fragment = matrix * texel (row-major, plain RGBA), clamped to [0, 1].
struct LinearMap {
  std::array<float, 16> matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  /// True: the application blends with SRC_ALPHA, so colour is multiplied by alpha after the map. False: colour
  /// is already premultiplied.
  bool multiply_by_alpha = true;
  /// Fragments whose mapped alpha is not greater than this are discarded, as by the application's alpha test;
  /// negative: none.
  float alpha_above = -1.0F;

  bool operator==(const LinearMap&) const = default;
};

/// Colour and opacity of a segment (see SliceSegment) by the values of its front and back samples: edge x edge
/// plain RGBA entries, edge >= 2, at low + i (high - low) / (edge - 1) in both directions, the front value
/// varying fastest; bilinear between entries, constant outside [low, high]. Alpha is the opacity of one
/// segment.
struct PreIntegrationTable {
  float low = 0.0F;
  float high = 1.0F;
  int edge = 0;
  std::vector<Rgba> entries;
  /// True: colour is multiplied by alpha after interpolation. False: it is already premultiplied.
  bool multiply_by_alpha = true;

  bool operator==(const PreIntegrationTable&) const = default;
};

/// Converts samples to colours: of scalars, of colours, or of segments between scalars.
using Classification = std::variant<TransferFunction, LinearMap, PreIntegrationTable>;

}  // namespace understudy::volume
