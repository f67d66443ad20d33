// SPDX-License-Identifier: Apache-2.0
#include "volume/raycast/occupancy_map.h"

#include <algorithm>

namespace understudy::volume {

OccupancyMap::OccupancyMap(const std::array<int, 3>& counts, std::vector<bool> shows) {
  const int nx = counts[0], ny = counts[1], nz = counts[2];
  distances_.assign(shows.size() + 3, 0);
  for (std::size_t b = 0; b < shows.size(); ++b)
    if (!shows[b]) {
      distances_[b] = 255;
      ++empty_bricks_;
    }
  if (empty_bricks_ == 0) return;

  // Two sweeps, each over the half of the 26 neighbours that it has already passed, are exact for this metric.
  const auto relax = [&](int x, int y, int z, int direction) {
    std::uint8_t& here = distances_[(std::size_t(z) * ny + y) * nx + x];
    if (here == 0) return;
    int least = here;
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const int passed = direction * (9 * dz + 3 * dy + dx);
          const int X = x + dx, Y = y + dy, Z = z + dz;
          if (passed >= 0 || X < 0 || Y < 0 || Z < 0 || X >= nx || Y >= ny || Z >= nz) continue;
          least = std::min(least, distances_[(std::size_t(Z) * ny + Y) * nx + X] + 1);
        }
    here = std::uint8_t(least);
  };
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x) relax(x, y, z, 1);
  for (int z = nz - 1; z >= 0; --z)
    for (int y = ny - 1; y >= 0; --y)
      for (int x = nx - 1; x >= 0; --x) relax(x, y, z, -1);
}

}  // namespace understudy::volume
