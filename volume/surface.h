// SPDX-License-Identifier: Apache-2.0
// Iso-surfaces: the points at which the field has a certain value.
#pragma once

#include <cstddef>

#include "volume/rgba.h"

namespace understudy::volume {

/// Most surfaces of one request.
constexpr std::size_t max_surfaces = 16;

/// Where the linearly filtered field passes `value`, on its way between two samples of a ray: from below to at
/// least the value, or back. Passing it twice between two samples goes unnoticed.
struct Surface {
  double value = 0.5;       ///< normalised as the values of a TransferFunction
  Rgba colour{1, 1, 1, 1};  ///< plain; alpha is the opacity of passing it once

  bool operator==(const Surface&) const = default;
};

}  // namespace understudy::volume
