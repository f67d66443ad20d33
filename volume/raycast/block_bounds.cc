// SPDX-License-Identifier: Apache-2.0
#include "volume/raycast/block_bounds.h"

#include <algorithm>
#include <limits>

namespace understudy::volume {

std::vector<float> block_bounds(const BrickStore& store, const TransferTable& table) {
  const auto negative = [](float component) { return !(component >= 0); };
  if (std::any_of(table.rows(), table.rows() + 4, negative)) return {};
  for (std::size_t i = 0; i + 1 < table.entries(); ++i) {
    const float* slope = table.rows() + 8 * i + 4;
    if (std::any_of(slope, slope + 4, negative)) return {};
  }
  std::vector<float> bounds(store.blocks());
  for (std::size_t b = 0; b < bounds.size(); ++b) bounds[b] = block_bound(store, table, b);
  return bounds;
}

float block_bound(const BrickStore& store, const TransferTable& table, std::size_t block) {
  const BrickStore::Range& range = store.ranges(block).front();
  if (!(range.low <= range.high)) return -std::numeric_limits<float>::infinity();
  const float place = std::clamp((range.high - table.low()) * table.scale(), 0.0F, table.last());
  const auto entry = std::size_t(place);
  const float* row = table.rows() + 8 * entry;
  const auto component = [&](std::size_t k) { return row[k] + (place - float(entry)) * row[4 + k]; };
  return (component(0) + component(1)) + (component(2) + component(3));
}

}  // namespace understudy::volume
