// SPDX-License-Identifier: Apache-2.0
// A number that ought to be, and the interval in which that of an honest renderer may lie: the errors that its
// arithmetic is allowed are carried through every operation, so that the last interval is the bound of a test.
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

/// `meant`, where it is open which of the two it is.
inline Bounded either(const Bounded& meant, const Bounded& other) {
  return {std::min(meant.low, other.low), meant.meant, std::max(meant.high, other.high)};
}

inline Bounded clamped(const Bounded& value) {
  return {std::clamp(value.low, 0.0, 1.0), std::clamp(value.meant, 0.0, 1.0), std::clamp(value.high, 0.0, 1.0)};
}

}  // namespace emulation
