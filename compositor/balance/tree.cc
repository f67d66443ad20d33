#include "compositor/balance/tree.h"

#include <algorithm>

namespace understudy::compositor {

using volume::Partition;
using volume::TexelBox;

std::vector<int> ranks_under(const Partition& partition, int child) {
  if (child < 0) return {~child};
  const Partition::Split& split = partition.splits[std::size_t(child)];
  std::vector<int> ranks = ranks_under(partition, split.low);
  const std::vector<int> high = ranks_under(partition, split.high);
  ranks.insert(ranks.end(), high.begin(), high.end());
  return ranks;
}

std::array<int, 3> layers_needed(const Partition& partition, int child) {
  if (child < 0) return {1, 1, 1};
  const Partition::Split& split = partition.splits[std::size_t(child)];
  const std::array<int, 3> low = layers_needed(partition, split.low),
                           high = layers_needed(partition, split.high);
  std::array<int, 3> layers{};
  for (int k = 0; k < 3; ++k)
    layers[std::size_t(k)] = k == split.axis ? low[std::size_t(k)] + high[std::size_t(k)]
                                             : std::max(low[std::size_t(k)], high[std::size_t(k)]);
  return layers;
}

int allowed_cut(const Partition& partition, std::size_t split, const TexelBox& box, const TexelBox& lattice,
                int edge, int cut) {
  const Partition::Split& here = partition.splits[split];
  const auto axis = std::size_t(here.axis);
  const int low = box.low[axis], high = box.high[axis];
  const int origin = lattice.low[axis];
  // Faces of layers inside the box; its own faces may lie between two layers.
  const int first = (low - origin) / edge + layers_needed(partition, here.low)[axis];
  const int last = (high - origin + edge - 1) / edge - layers_needed(partition, here.high)[axis];
  if (first > last) return std::clamp(cut, low, high);
  return std::clamp(cut, std::min(high, origin + first * edge), std::min(high, origin + last * edge));
}

}  // namespace understudy::compositor
