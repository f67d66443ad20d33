// SPDX-License-Identifier: Apache-2.0
// Procedural volumes. They have structure everywhere, and no two of their octants are alike.
#pragma once

#include <functional>
#include <vector>

namespace adversary {

/// Of texture coordinates.
using Field = std::function<float(float x, float y, float z)>;

/// Between 0 and 1: waves of several lengths along and across the axes.
float waves(float x, float y, float z);
/// Between 0 and 1: shells around a point that is not the centre.
float shells(float x, float y, float z);

/// Values at the texels' centres, x fastest. Colours have four values each, others one.
struct Grid {
  int x = 0, y = 0, z = 0;
  int channels = 1;
  std::vector<float> values;
};

Grid sampled(int x, int y, int z, const Field& field);
inline Grid sampled(int edge, const Field& field) {
  return sampled(edge, edge, edge, field);
}
/// Colours with opacity, as a viewer that classifies before it uploads.
Grid coloured(const Grid& grid);
/// The texels from (x, y, z) on, as large as `size`.
Grid part_of(const Grid& grid, int x, int y, int z, int size_x, int size_y, int size_z);
Grid scaled(Grid grid, float factor, float offset = 0);

}  // namespace adversary
