#include "volume/kd_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "volume/brick/brick_store.h"

namespace understudy::volume {

namespace {

/// Where to cut `extent` cells (starting `offset` cells into the lattice) for `left` of `ranks`: on the block
/// face nearest to the fair share, or between any two cells when no block face lies inside.
int split_position(int offset, int extent, int left, int ranks) {
  constexpr int block = BrickStore::block_cells;
  const double fair = double(extent) * left / ranks;
  const int lowest = (offset / block + 1) * block - offset;              // first block face inside
  const int highest = ((offset + extent - 1) / block) * block - offset;  // last one
  if (lowest > highest) return std::clamp(int(std::lround(fair)), 1, extent - 1);
  const int nearest = int(std::lround((offset + fair) / block)) * block - offset;
  return std::clamp(nearest, lowest, highest);
}

}  // namespace

KdTree::KdTree(const VolumeDescription& volume, int ranks) {
  if (ranks < 1 || ranks > max_ranks)
    throw std::invalid_argument(
        fmt::format("a volume cannot be divided among {} ranks (1 to {} are possible)", ranks, max_ranks));
  boxes_.resize(std::size_t(ranks));
  const TexelBox lattice = cell_lattice(volume).box();
  root_ = divide(volume, lattice, lattice, 0, ranks);
}

int KdTree::divide(const VolumeDescription& volume, const TexelBox& lattice, const TexelBox& cells,
                   int first_rank, int ranks) {
  if (ranks == 1) {
    boxes_[std::size_t(first_rank)] = cells;
    return ~first_rank;
  }
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (cells.high[k] - cells.low[k] > cells.high[axis] - cells.low[axis]) axis = k;
  const int extent = cells.high[axis] - cells.low[axis];
  const int left_ranks = ranks / 2;
  const int cut = extent < 2 ? cells.high[axis]
                             : cells.low[axis] + split_position(cells.low[axis] - lattice.low[axis], extent,
                                                                left_ranks, ranks);

  const int index = int(nodes_.size());
  nodes_.push_back({axis, (cut + 0.5) / volume.size[axis], 0, 0});
  TexelBox low = cells, high = cells;
  low.high[axis] = cut;
  high.low[axis] = cut;
  const int low_child = divide(volume, lattice, low, first_rank, left_ranks);
  const int high_child = divide(volume, lattice, high, first_rank + left_ranks, ranks - left_ranks);
  nodes_[std::size_t(index)].low = low_child;
  nodes_[std::size_t(index)].high = high_child;
  return index;
}

void KdTree::walk(int child, const Sight& sight, std::vector<int>& order) const {
  if (child < 0) {
    order.push_back(~child);
    return;
  }
  const Node& node = nodes_[std::size_t(child)];
  const bool high_first = sight.high_first(node.axis, node.plane);
  walk(high_first ? node.high : node.low, sight, order);
  walk(high_first ? node.low : node.high, sight, order);
}

std::vector<int> KdTree::visibility_order(const Sight& sight) const {
  std::vector<int> order;
  order.reserve(boxes_.size());
  walk(root_, sight, order);
  return order;
}

std::vector<int> KdTree::visibility_order(const Matrix4& texture_to_clip) const {
  return visibility_order(Sight(texture_to_clip));
}

std::vector<int> KdTree::visibility_order(const RenderRequest& request) const {
  return visibility_order(Sight(request));
}

}  // namespace understudy::volume
