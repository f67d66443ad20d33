// SPDX-License-Identifier: Apache-2.0
// Iso-surfaces: the points at which the field has a given value.
#pragma once

#include <cstddef>

#include "volume/rgba.h"

namespace understudy::volume {

/// Most surfaces of one request.
constexpr std::size_t max_surfaces = 16;

/// Where the linearly filtered field crosses `value` between two samples of a ray: from below `value` to at
/// least `value`, or back. Two crossings between the same two samples are missed.
struct Surface {
  double value = 0.5;       ///< normalised as the values of a TransferFunction
  Rgba colour{1, 1, 1, 1};  ///< plain; alpha is the opacity of one crossing

  bool operator==(const Surface&) const = default;
};

}  // namespace understudy::volume
