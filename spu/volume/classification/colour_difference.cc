// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/classification/colour_difference.h"

#include <algorithm>
#include <cmath>

namespace understudy::spu {

float largest_difference(const volume::Rgba& a, const volume::Rgba& b) {
  float largest = 0;
  for (std::size_t c = 0; c < 4; ++c) {
    const float difference = std::abs(a[c] - b[c]);
    if (std::isnan(difference)) return difference;
    largest = std::max(largest, difference);
  }
  return largest;
}

bool finite(const std::vector<volume::Rgba>& colours) {
  return std::all_of(colours.begin(), colours.end(), [](const volume::Rgba& colour) {
    return std::all_of(colour.begin(), colour.end(), [](float x) { return std::isfinite(x); });
  });
}

}  // namespace understudy::spu
