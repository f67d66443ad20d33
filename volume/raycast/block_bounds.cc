#include "volume/raycast/block_bounds.h"

#include <algorithm>
#include <limits>

namespace understudy::volume {

std::vector<float> block_bounds(const BrickStore& store, const TransferTable& table) {
  for (std::size_t i = 0; i + 1 < table.entries(); ++i) {
    const float* slope = table.rows() + 8 * i + 4;
    if (!(slope[0] > 0 && slope[1] >= 0 && slope[2] >= 0 && slope[3] >= 0)) return {};
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
  return row[0] + (place - float(entry)) * row[4];
}

}  // namespace understudy::volume
