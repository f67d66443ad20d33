// SPDX-License-Identifier: Apache-2.0
#include "volume/brick_grid.h"

#include <algorithm>
#include <numeric>

#include "volume/request.h"
#include "volume/visibility_order.h"

namespace understudy::volume {

BrickGrid BrickGrid::covering(const std::array<int, 3>& first, const std::array<int, 3>& end, int edge) {
  BrickGrid grid{first, {}, edge};
  for (std::size_t axis = 0; axis < 3; ++axis)
    grid.counts[axis] = (std::max(end[axis] - first[axis], 0) + edge - 1) / edge;
  return grid;
}

std::size_t BrickGrid::bricks() const {
  return std::size_t(counts[0]) * std::size_t(counts[1]) * std::size_t(counts[2]);
}

std::array<int, 3> BrickGrid::place(std::size_t brick) const {
  const auto row = std::size_t(counts[0]), rows = std::size_t(counts[1]);
  return {int(brick % row), int(brick / row % rows), int(brick / row / rows)};
}

TexelBox BrickGrid::cells(std::size_t brick) const {
  const std::array<int, 3> at = place(brick);
  TexelBox box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = origin[axis] + at[axis] * edge;
    box.high[axis] = box.low[axis] + edge;
  }
  return box;
}

std::vector<std::size_t> BrickGrid::in_visibility_order(const VolumeDescription& volume,
                                                        const RenderRequest& request) const {
  // Whichever face a ray crosses, the sum of its brick's three counts increases by one.
  const VisibilityOrder visibility(request);
  std::array<std::vector<int>, 3> along;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<int>& counted = along[std::size_t(axis)];
    const auto a = std::size_t(axis);
    counted.assign(std::size_t(counts[a]), 0);
    for (std::size_t i = 1; i < counted.size(); ++i) {
      const double face = (origin[a] + int(i) * edge + 0.5) / volume.size[a];
      counted[i] = counted[i - 1] + (visibility.high_first(axis, face) ? -1 : 1);
    }
  }
  const auto passed = [&](std::size_t brick) {
    const std::array<int, 3> at = place(brick);
    return along[0][std::size_t(at[0])] + along[1][std::size_t(at[1])] + along[2][std::size_t(at[2])];
  };
  std::vector<std::size_t> order(bricks());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return passed(a) < passed(b); });
  return order;
}

}  // namespace understudy::volume
