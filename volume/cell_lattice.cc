// SPDX-License-Identifier: Apache-2.0
#include "volume/cell_lattice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace understudy::volume {

namespace {

bool joins_its_ends(const VolumeDescription& volume, int axis) {
  return volume.wrap[axis] == Wrap::repeat && volume.stored.low[axis] == 0 &&
         volume.stored.high[axis] == volume.size[axis];
}

}  // namespace

CellLattice cell_lattice(const VolumeDescription& volume) {
  CellLattice lattice;
  for (int axis = 0; axis < 3; ++axis) {
    const int size = volume.size[axis], low = volume.stored.low[axis], high = volume.stored.high[axis];
    if (size < 1 || size > max_axis_texels)
      throw std::invalid_argument(fmt::format("volume {}: {} texels along axis {} (1 to {} are possible)",
                                              volume.id, size, axis, max_axis_texels));
    if (low < 0 || high <= low || high > size)
      throw std::invalid_argument(fmt::format("volume {}: stored texels {} to {} along axis {} of {} texels",
                                              volume.id, low, high, axis, size));
    if (joins_its_ends(volume, axis)) {
      lattice.origin[axis] = -1;
      lattice.cells[axis] = size + 1;
    } else {
      lattice.origin[axis] = low;
      lattice.cells[axis] = std::max(1, high - low - 1);
    }
  }
  return lattice;
}

TexelBox shown_cells(const VolumeDescription& volume) {
  const TexelBox all = cell_lattice(volume).box();
  if (!volume.part) return all;
  if (is_empty(*volume.part) || !contains(all, *volume.part))
    throw std::invalid_argument(
        fmt::format("volume {}: its part, cells ({}, {}, {}) to ({}, {}, {}), is empty or none of it",
                    volume.id, volume.part->low[0], volume.part->low[1], volume.part->low[2],
                    volume.part->high[0], volume.part->high[1], volume.part->high[2]));
  return *volume.part;
}

int lattice_texel(const VolumeDescription& volume, const CellLattice& lattice, int axis, int index) {
  const int texel = lattice.origin[axis] + index;
  if (joins_its_ends(volume, axis)) return (texel + volume.size[axis]) % volume.size[axis];
  return std::min(texel, volume.stored.high[axis] - 1);
}

Box texture_box(const VolumeDescription& volume, const TexelBox& cells) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const CellLattice lattice = cell_lattice(volume);
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    // Positions are floats in lattice coordinates; their error grows with the size of the lattice.
    const double slack = std::max(1e-3, 1e-6 * lattice.cells[axis]);
    const int rim = lattice.origin[axis] + lattice.cells[axis];
    const auto texture = [&](double u) { return (u + 0.5) / volume.size[axis]; };
    box.low[axis] = cells.low[axis] <= lattice.origin[axis] ? -infinity : texture(cells.low[axis] - slack);
    box.high[axis] = cells.high[axis] >= rim ? infinity : texture(cells.high[axis] + slack);
  }
  return box;
}

bool is_all_of_texture(const Box& region, const std::array<int, 3>& size) {
  constexpr double rounding = 1e-6;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double end = 0.5 / size[axis] + rounding;
    if (region.low[axis] > end || region.high[axis] < 1 - end) return false;
  }
  return true;
}

}  // namespace understudy::volume
