// SPDX-License-Identifier: Apache-2.0
// Fog (depth cueing): changes the colour of a sample with its distance from the eye, but not its opacity. A
// sample of premultiplied colour c and opacity a at point t of texture space contributes
//
//     weight(u) c + a added(u),   u = normal . t + offset
//
// Linear, exponential and clamped fog of any colour have this form.
#pragma once

#include <array>
#include <vector>

#include "volume/rgba.h"

namespace understudy::volume {

/// `normal` and `offset` map a point of texture space to u; see above.
struct Fog {
  std::array<double, 3> normal{};
  double offset = 0;
  /// N >= 2 entries at u = i / (N - 1), linear between entries and constant outside [0, 1]. The first three
  /// components are the added colour, the last is the weight.
  std::vector<Rgba> entries;

  bool operator==(const Fog&) const = default;
};

}  // namespace understudy::volume
