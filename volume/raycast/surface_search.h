// SPDX-License-Identifier: Apache-2.0
// Where on a segment the field passes a value: between two ends on different sides of it, by the rule of false
// position (in the Illinois form, which halves the value at an end that stays), and by bisection where that is
// slow. A field may be even at the very value: it passes where it comes to have it, or ceases to.
#pragma once

#include <cmath>

namespace understudy::volume {

/// The search ends when the point is known to so many cells.
constexpr float surface_tolerance = 2e-4F;
/// From a point that has the very value the search goes on with one so many tolerances away.
constexpr float surface_nudge = 0.125F;
/// After so many rounds it bisects, and after so many more it ends: 2^-18 of a segment.
constexpr int false_positions = 6;
constexpr int bisections = 18;

/// What is left of a segment in front of which the search has come.
struct SurfaceSearch {
  float front = 0;  ///< as a share of the segment
  float at_front = 0;
  float at_back = 0;

  /// Moves the front to where the field passes `level`, which lies between the values at front and back. The
  /// segment is `cells` long; value_at(share) is the field on it. False where the field is not a number on the
  /// way.
  template <typename ValueAt>
  bool find(float level, float cells, ValueAt value_at) {
    const bool above = at_front >= level;
    float a = front, b = 1, at_a = at_front - level, at_b = at_back - level;
    int stays = 0;  // -1: the back has moved, 1: the front has
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
