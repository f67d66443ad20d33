// SPDX-License-Identifier: Apache-2.0
// Fog, or depth cueing: what the way from the eye does to the colour of a sample, without a word about its
// opacity. A sample of colour c and opacity a, premultiplied, shows
//
//     weight(u) c + a added(u),   u = normal . t + offset
//
// at the point t of texture space. Linear, exponential and clamped fog of any colour are all of this form.
#pragma once

#include <array>
#include <vector>

#include "volume/rgba.h"

namespace understudy::volume {

/// `normal` and `offset` make u of a point of texture space; see above.
struct Fog {
  std::array<double, 3> normal{};
  double offset = 0;
  /// N >= 2 entries at u = i / (N - 1), linear between entries and constant outside [0, 1]: added colour in the
  /// first three components, weight in the last.
  std::vector<Rgba> entries;

  bool operator==(const Fog&) const = default;
};

}  // namespace understudy::volume
