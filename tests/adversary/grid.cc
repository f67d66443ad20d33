// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "tests/adversary/transfer_function.h"

namespace adversary {
namespace {

std::size_t index(const Grid& grid, int x, int y, int z) {
  return static_cast<std::size_t>(grid.channels) *
         (static_cast<std::size_t>(x) +
          static_cast<std::size_t>(grid.x) * (y + static_cast<std::size_t>(grid.y) * z));
}

}  // namespace

float waves(float x, float y, float z) {
  const float sum = std::sin(7 * x + 4 * y + 1) + std::sin(9 * y - 3 * z) + std::sin(8 * z + 5 * x + 2) +
                    0.7F * std::sin(19 * x * y + 13 * z) + 0.5F * std::sin(23 * (x - y * z));
  return std::clamp(0.5F + 0.16F * sum, 0.0F, 1.0F);
}

float shells(float x, float y, float z) {
  const float distance =
      std::sqrt((x - 0.4F) * (x - 0.4F) + (y - 0.55F) * (y - 0.55F) + (z - 0.6F) * (z - 0.6F));
  return std::clamp(0.5F + 0.35F * std::sin(22 * distance + 2 * x) + 0.15F * std::sin(9 * y), 0.0F, 1.0F);
}

Grid sampled(int x, int y, int z, const Field& field) {
  Grid grid{x, y, z, 1, {}};
  grid.values.reserve(static_cast<std::size_t>(x) * y * z);
  for (int k = 0; k < z; ++k)
    for (int j = 0; j < y; ++j)
      for (int i = 0; i < x; ++i)
        grid.values.push_back(field((i + 0.5F) / static_cast<float>(x), (j + 0.5F) / static_cast<float>(y),
                                    (k + 0.5F) / static_cast<float>(z)));
  return grid;
}

Grid coloured(const Grid& grid) {
  const std::vector<Colour> table = soft_colours();
  Grid colours{grid.x, grid.y, grid.z, 4, {}};
  for (const float value : grid.values)
    for (const std::uint8_t channel : table[static_cast<std::size_t>(std::lround(255 * value))])
      colours.values.push_back(static_cast<float>(channel) / 255);
  return colours;
}

Grid part_of(const Grid& grid, int x, int y, int z, int size_x, int size_y, int size_z) {
  Grid part{size_x, size_y, size_z, grid.channels, {}};
  for (int k = 0; k < size_z; ++k)
    for (int j = 0; j < size_y; ++j) {
      const auto row = grid.values.begin() + static_cast<std::ptrdiff_t>(index(grid, x, y + j, z + k));
      part.values.insert(part.values.end(), row, row + static_cast<std::ptrdiff_t>(size_x) * grid.channels);
    }
  return part;
}

Grid scaled(Grid grid, float factor, float offset) {
  for (float& value : grid.values) value = factor * value + offset;
  return grid;
}

}  // namespace adversary
