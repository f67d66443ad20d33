// SPDX-License-Identifier: Apache-2.0
#include "volume/kd_tree.h"

#include <utility>

#include "volume/request.h"
#include "volume/visibility_order.h"

namespace understudy::volume {

KdTree::KdTree(const VolumeDescription& volume, Partition partition)
    : partition_(std::move(partition)), boxes_(volume::boxes(partition_, volume)) {
  for (const Partition::Split& split : partition_.splits)
    planes_.push_back((split.cut + 0.5) / volume.size[std::size_t(split.axis)]);
}

KdTree::KdTree(const VolumeDescription& volume, int ranks) : KdTree(volume, by_blocks(volume, ranks)) {}

void KdTree::walk(int child, const VisibilityOrder& visibility, std::vector<int>& order) const {
  if (child < 0) {
    order.push_back(~child);
    return;
  }
  const Partition::Split& node = partition_.splits[std::size_t(child)];
  const bool high_first = visibility.high_first(node.axis, planes_[std::size_t(child)]);
  walk(high_first ? node.high : node.low, visibility, order);
  walk(high_first ? node.low : node.high, visibility, order);
}

std::vector<int> KdTree::visibility_order(const VisibilityOrder& visibility) const {
  std::vector<int> order;
  order.reserve(boxes_.size());
  walk(root(), visibility, order);
  return order;
}

std::vector<int> KdTree::visibility_order(const Matrix4& texture_to_clip) const {
  return visibility_order(VisibilityOrder(texture_to_clip));
}

std::vector<int> KdTree::visibility_order(const RenderRequest& request) const {
  return visibility_order(VisibilityOrder(request));
}

}  // namespace understudy::volume
