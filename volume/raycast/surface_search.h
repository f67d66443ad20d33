// SPDX-License-Identifier: Apache-2.0
// Finds where a segment crosses a value of the field: between two ends on different sides of it, by regula
// falsi (Illinois variant, which halves the value at an end that stays), and by bisection if that converges
// slowly. If the field equals the value over an interval, the crossing is where it begins or ceases to.
#pragma once

#include <cmath>

namespace understudy::volume {

/// The search ends when the position is known to this many cells.
constexpr float surface_tolerance = 2e-4F;
/// From a position with exactly the value sought, the search continues this many tolerances away.
constexpr float surface_nudge = 0.125F;
/// After this many rounds it bisects, for this many more at most: 2^-18 of a segment.
constexpr int false_positions = 6;
constexpr int bisections = 18;

/// The rest of a segment, behind the positions already found.
struct SurfaceSearch {
  float front = 0;  ///< as a fraction of the segment
  float at_front = 0;
  float at_back = 0;

  /// Moves the front to where the field crosses `level`, which lies between the values at front and back. The
  /// segment is `cells` long; value_at(share) is the field on it. Returns false if the field is NaN on the way.
  template <typename ValueAt>
  bool find(float level, float cells, ValueAt value_at) {
    const bool above = at_front >= level;
    float a = front, b = 1, at_a = at_front - level, at_b = at_back - level;
    int stays = 0;  // which end moved last; -1: the back, 1: the front
    for (int round = 0; round < false_positions + bisections && (b - a) * cells > surface_tolerance; ++round) {
      float share = 0.5F * (a + b);
      if (round < false_positions) {
        const float nudge = surface_nudge * surface_tolerance / cells;
        share = at_b == 0 ? b - nudge : at_a == 0 ? a + nudge : b - at_b * ((b - a) / (at_b - at_a));
        share = share > a ? (share < b ? share : b) : a;
      }
      const float there = value_at(share) - level;
      if (std::isnan(there)) return false;
      if ((there >= 0) == above) {
        a = share;
        at_a = there;
        if (stays == 1) at_b *= 0.5F;
        stays = 1;
      } else {
        b = share;
        at_b = there;
        if (stays == -1) at_a *= 0.5F;
        stays = -1;
      }
    }
    front = 0.5F * (a + b);
    at_front = level;
    return true;
  }
};

}  // namespace understudy::volume
