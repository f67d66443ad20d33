// SPDX-License-Identifier: Apache-2.0
// From a sample of the field to colour and opacity.
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
/// (glow).
struct TransferFunction {
  float low = 0.0F;
  float high = 1.0F;
  std::vector<Rgba> entries;

  bool operator==(const TransferFunction&) const = default;
};

/// At a place in a function, counted in entries, between the first and the last.
inline std::array<double, 4> entry_at(const TransferFunction& function, double place) {
  const auto below = std::min(std::size_t(place), function.entries.size() - 2);
  std::array<double, 4> entry{};
  for (std::size_t k = 0; k < 4; ++k) {
    const double a = function.entries[below][k], b = function.entries[below + 1][k];
    entry[k] = a + (place - double(below)) * (b - a);
  }
  return entry;
}

/// A medium by the transfer function of steps of one length, and `step` of another request in these lengths,
/// whose transfer function is this one corrected to it (opacity_correction.h).
struct MediumFunction {
  TransferFunction function;
  double step = 1;

  bool operator==(const MediumFunction&) const = default;
};

/// A volume whose texels already are colours: fragment = matrix * texel (row-major, plain RGBA), clamped to [0,
/// 1].
struct LinearMap {
  std::array<float, 16> matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  /// The application blends with SRC_ALPHA: colour is multiplied by alpha after the map. False: it is
  /// premultiplied already.
  bool multiply_by_alpha = true;
  /// Fragments whose mapped alpha is not greater are discarded, as by the application's alpha test; negative:
  /// none.
  float alpha_above = -1.0F;

  bool operator==(const LinearMap&) const = default;
};

/// A transfer function of two samples, the front and the back of a segment (see SliceSegment): edge x edge
/// plain RGBA entries, edge >= 2, at low + i (high - low) / (edge - 1) in both directions, the front's running
/// faster; bilinear between entries and constant outside [low, high]. Alpha is the opacity of one segment.
struct PreIntegrationTable {
  float low = 0.0F;
  float high = 1.0F;
  int edge = 0;
  std::vector<Rgba> entries;
  /// Colour is multiplied by alpha after the interpolation. False: it is premultiplied already.
  bool multiply_by_alpha = true;

  bool operator==(const PreIntegrationTable&) const = default;
};

/// What turns samples into colours: of scalars, of colours, or of segments of scalars.
using Classification = std::variant<TransferFunction, LinearMap, PreIntegrationTable>;

}  // namespace understudy::volume
