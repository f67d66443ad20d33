// SPDX-License-Identifier: Apache-2.0
#include "volume/raycast/map_visibility.h"

#include <algorithm>
#include <array>

namespace understudy::volume {

bool shows(const LinearMap& map, std::span<const BrickStore::Range> texels) {
  std::array<float, 4> highest{};
  for (std::size_t row = 0; row < 4; ++row)
    for (std::size_t k = 0; k < 4; ++k) {
      const float m = map.matrix[4 * row + k] / 255.0F;
      highest[row] += std::max(m * texels[k].low, m * texels[k].high);
    }
  constexpr float rounding = 1e-5F;  // of the map, so that no fragment above the threshold is lost
  if (map.alpha_above >= 0 && highest[3] + rounding <= map.alpha_above) return false;
  if (map.multiply_by_alpha) return highest[3] > 0;
  return std::any_of(highest.begin(), highest.end(), [](float v) { return v > 0; });
}

}  // namespace understudy::volume
