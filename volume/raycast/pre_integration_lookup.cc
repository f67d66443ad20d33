// SPDX-License-Identifier: Apache-2.0
#include "volume/raycast/pre_integration_lookup.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace understudy::volume {

PreIntegrationLookup::PreIntegrationLookup(const PreIntegrationTable& table, TexelType type, float neutral)
    : edge_(table.edge), multiply_by_alpha_(table.multiply_by_alpha) {
  const double unit = type == TexelType::f32 ? 1 : type == TexelType::u16 ? 65535 : 255;
  low_ = float(table.low * unit);
  const double scale = double(edge_ - 1) / ((double(table.high) - double(table.low)) * unit);
  scale_ = float(std::min(scale, double(std::numeric_limits<float>::max())));

  const auto n = std::size_t(edge_);
  entries_.reserve(4 * (neutral_entry() + n + 2));
  for (const Rgba& entry : table.entries) entries_.insert(entries_.end(), entry.begin(), entry.end());
  entries_.resize(4 * (neutral_entry() + n + 2), neutral);

  showing_below_.resize((n + 1) * (n + 1));
  for (std::size_t back = 0; back < n; ++back) {
    std::uint32_t in_row = 0;
    for (std::size_t front = 0; front < n; ++front) {
      const Rgba& entry = table.entries[back * n + front];
      const bool shows = multiply_by_alpha_
                             ? entry[3] != 0
                             : std::any_of(entry.begin(), entry.end(), [](float v) { return v != 0; });
      in_row += shows ? 1 : 0;
      showing_below_[(back + 1) * (n + 1) + front + 1] = showing_below_[back * (n + 1) + front + 1] + in_row;
    }
  }
}

bool PreIntegrationLookup::shows(const BrickStore::Range& front, const BrickStore::Range& back) const {
  if (!(front.low <= front.high) || !(back.low <= back.high)) return false;
  const auto place = [&](float value) { return std::clamp((value - low_) * scale_, 0.0F, last()); };
  const auto from = [&](float value) { return std::size_t(std::floor(place(value))); };
  const auto to = [&](float value) { return std::size_t(std::ceil(place(value))) + 1; };
  const auto below = [&](std::size_t y, std::size_t x) {
    return showing_below_[y * (std::size_t(edge_) + 1) + x];
  };
  const std::size_t x0 = from(front.low), x1 = to(front.high), y0 = from(back.low), y1 = to(back.high);
  return below(y1, x1) + below(y0, x0) != below(y0, x1) + below(y1, x0);
}

std::vector<bool> blocks_with_slice_segments(const BrickStore& store, const PreIntegrationLookup& pairs,
                                             const std::array<int, 3>& reach, bool keeps_clear) {
  const std::size_t blocks = store.blocks();
  std::vector<BrickStore::Range> within(blocks);
  for (std::size_t b = 0; b < blocks; ++b) within[b] = store.ranges(b).front();
  std::size_t stride = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int count = store.block_counts()[axis];
    const std::vector<BrickStore::Range> before = within;
    for (std::size_t b = 0; b < blocks && reach[axis] > 0; ++b) {
      const int at = int(b / stride % std::size_t(count));
      const int low = std::max(at - reach[axis], 0), high = std::min(at + reach[axis], count - 1);
      for (int i = low; i <= high; ++i) {
        // A block without values has low > high and widens nothing.
        const BrickStore::Range& other = before[b + std::size_t(i) * stride - std::size_t(at) * stride];
        within[b].low = std::min(within[b].low, other.low);
        within[b].high = std::max(within[b].high, other.high);
      }
    }
    stride *= std::size_t(count);
  }
  std::vector<bool> visible(blocks);
  for (std::size_t b = 0; b < blocks; ++b) {
    const BrickStore::Range& front = store.ranges(b).front();
    visible[b] = keeps_clear ? front.low <= front.high : pairs.shows(front, within[b]);
  }
  return visible;
}

}  // namespace understudy::volume
