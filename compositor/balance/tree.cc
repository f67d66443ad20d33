// SPDX-License-Identifier: Apache-2.0
#include "compositor/balance/tree.h"

#include <algorithm>
#include <utility>

#include "compositor/balance/block_edge.h"
#include "volume/brick/brick_store.h"

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
  // Faces of layers inside the box; the box's own faces may lie within a layer.
  const int first = (low - origin) / edge + layers_needed(partition, here.low)[axis];
  const int last = (high - origin + edge - 1) / edge - layers_needed(partition, here.high)[axis];
  if (first > last) return std::clamp(cut, low, high);
  return std::clamp(cut, std::min(high, origin + first * edge), std::min(high, origin + last * edge));
}

std::size_t blocks_in(const TexelBox& box) {
  std::size_t blocks = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    const int layers = (box.high[k] - box.low[k] + block_edge - 1) / block_edge;
    blocks *= std::size_t(layers);
  }
  return blocks;
}

std::vector<TexelBox> boxes_of(const Partition& partition, const TexelBox& lattice) {
  std::vector<TexelBox> boxes(std::size_t(partition.ranks), lattice);
  Partition walked = partition;
  walk_splits(walked, lattice, [&](std::size_t i, const TexelBox& box) {
    const Partition::Split& split = walked.splits[i];
    const auto axis = std::size_t(split.axis);
    if (const int rank = ~split.low; rank >= 0) {
      boxes[std::size_t(rank)] = box;
      boxes[std::size_t(rank)].high[axis] = split.cut;
    }
    if (const int rank = ~split.high; rank >= 0) {
      boxes[std::size_t(rank)] = box;
      boxes[std::size_t(rank)].low[axis] = split.cut;
    }
  });
  return boxes;
}

Partition with_room(const Partition& now, const Partition& next, const TexelBox& lattice,
                    std::span<const std::size_t> most_blocks) {
  if (most_blocks.empty()) return next;
  const auto fits = [&](const Partition& partition) {
    const std::vector<TexelBox> boxes = boxes_of(partition, lattice);
    for (std::size_t rank = 0; rank < boxes.size(); ++rank)
      if (blocks_in(boxes[rank]) > most_blocks[rank]) return false;
    return true;
  };
  const auto allowed = [&](Partition cuts) {
    walk_splits(cuts, lattice, [&](std::size_t i, const TexelBox& box) {
      cuts.splits[i].cut = allowed_cut(cuts, i, box, lattice, block_edge, cuts.splits[i].cut);
    });
    return cuts;
  };
  if (fits(next)) return next;
  // All planes go the largest common fraction of their way that leaves every rank enough room.
  constexpr int parts = 16;
  for (int part = parts - 1; part > 0; --part) {
    Partition candidate = now;
    for (std::size_t i = 0; i < now.splits.size(); ++i)
      candidate.splits[i].cut +=
          (next.splits[i].cut - now.splits[i].cut) / block_edge * part / parts * block_edge;
    candidate = allowed(std::move(candidate));
    if (candidate != now && fits(candidate)) return candidate;
  }
  // A step of one layer cannot be divided: each plane in turn then goes all the way, or stays.
  Partition result = now;
  for (std::size_t i = 0; i < now.splits.size(); ++i) {
    Partition candidate = result;
    candidate.splits[i].cut += next.splits[i].cut - now.splits[i].cut;
    candidate = allowed(std::move(candidate));
    if (fits(candidate)) result = std::move(candidate);
  }
  return result;
}

}  // namespace understudy::compositor
