// SPDX-License-Identifier: Apache-2.0
// A value in exact arithmetic, and the interval in which a correct renderer's value may lie. Every operation
// propagates the errors that the renderer's arithmetic is allowed; a test's bound is the final interval.
#pragma once

#include <algorithm>

namespace emulation {

struct Bounded {
  double low = 0;
  double meant = 0;
  double high = 0;
};

inline Bounded exactly(double value) {
  return {value, value, value};
}

inline Bounded within(double error, const Bounded& value) {
  return {value.low - error, value.meant, value.high + error};
}

/// `meant`, widened to cover `other`, where either may be the result.
inline Bounded either(const Bounded& meant, const Bounded& other) {
  return {std::min(meant.low, other.low), meant.meant, std::max(meant.high, other.high)};
}

inline Bounded clamped(const Bounded& value) {
  return {std::clamp(value.low, 0.0, 1.0), std::clamp(value.meant, 0.0, 1.0), std::clamp(value.high, 0.0, 1.0)};
}

}  // namespace emulation
