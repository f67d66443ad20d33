// SPDX-License-Identifier: Apache-2.0
#include "volume/block_costs.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "volume/cell_lattice.h"

namespace understudy::volume {

BlockCosts::BlockCosts(const TexelBox& lattice, int edge) : lattice_(lattice), edge_(edge) {
  if (edge < block_cells || edge % block_cells != 0 || is_empty(lattice))
    throw std::invalid_argument(
        fmt::format("costs of cubes of {} cells: give a multiple of {}, and a lattice that is not empty", edge,
                    block_cells));
  std::size_t cubes = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    counts_[axis] = (lattice.high[axis] - lattice.low[axis] + edge - 1) / edge;
    cubes *= std::size_t(counts_[axis]);
  }
  values_.resize(cubes);
}

TexelBox BlockCosts::cubes_of(const TexelBox& cells) const {
  TexelBox cubes;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto first_at = [&](int cell) {
      return std::clamp((cell - lattice_.low[axis] + edge_ - 1) / edge_, 0, counts_[axis]);
    };
    cubes.low[axis] = first_at(cells.low[axis]);
    cubes.high[axis] = std::max(cubes.low[axis], first_at(cells.high[axis]));
  }
  return cubes;
}

CostSums::CostSums(const BlockCosts& costs) : costs_(&costs) {
  const auto [nx, ny, nz] = costs.counts();
  const std::size_t row = std::size_t(nx) + 1, slice = row * (std::size_t(ny) + 1);
  sums_.resize(slice * (std::size_t(nz) + 1));
  const double* value = costs.values().data();
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y) {
      double in_row = 0;
      double* sum = &sums_[slice * (std::size_t(z) + 1) + row * (std::size_t(y) + 1)];
      for (int x = 0; x < nx; ++x) {
        in_row += *value++;
        ++sum;
        *sum = in_row + *(sum - row) + *(sum - slice) - *(sum - row - slice);
      }
    }
}

double CostSums::within(const TexelBox& cells) const {
  const TexelBox cubes = costs_->cubes_of(cells);
  const auto [nx, ny, nz] = costs_->counts();
  const std::size_t row = std::size_t(nx) + 1, slice = row * (std::size_t(ny) + 1);
  const auto below = [&](int x, int y, int z) {
    return sums_[slice * std::size_t(z) + row * std::size_t(y) + std::size_t(x)];
  };
  const auto in_slices = [&](int z) {
    return below(cubes.high[0], cubes.high[1], z) - below(cubes.low[0], cubes.high[1], z) -
           below(cubes.high[0], cubes.low[1], z) + below(cubes.low[0], cubes.low[1], z);
  };
  return in_slices(cubes.high[2]) - in_slices(cubes.low[2]);
}

}  // namespace understudy::volume
