// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/texture/value_range.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "spu/volume/texture/texels.h"

namespace understudy::spu {
namespace {

/// Returns the least number of values, `needed` or more, that divides a table's intervals or is a multiple of
/// them.
int values_that_fit(int needed) {
  constexpr int intervals = probed_entries - 1;
  if (needed > intervals) return (needed + intervals - 1) / intervals * intervals;
  int entries_a_value = intervals / needed;
  while (intervals % entries_a_value != 0) --entries_a_value;
  return intervals / entries_a_value;
}

/// Rounds the range of texels that are multiples of 1 / `steps`, within `held`.
std::array<float, 2> rounded_outwards(std::array<float, 2> range, std::array<float, 2> held, int steps) {
  const auto value = [&](float number) { return int(std::lround(double(number) * steps)); };
  const int least = value(held[0]);
  const int greatest = value(held[1]);
  // Both ends move in strides of an eighth to a quarter of the range.
  const int stride = std::max(int(std::bit_ceil(unsigned(value(range[1]) - value(range[0]) + 1))) / 8, 1);
  int low = least + (value(range[0]) - least) / stride * stride;
  const int high = std::min(least + ((value(range[1]) - least) / stride + 1) * stride, greatest);
  // Never more than 16 entries per value, as over 8 bits.
  const int values = values_that_fit(std::max(high - low, 255));
  if (values > greatest - least + 1) return held;
  low = std::min(low, greatest - values);
  return {float(double(low) / steps), float(double(low + values) / steps)};
}

/// Returns how many values, without the first, normalised texels can have in the range.
int values_within(const TextureDescription& description, const std::array<float, 2>& range) {
  return int(std::lround((double(range[1]) - range[0]) * description.steps));
}

}  // namespace

std::array<float, 2> value_range(const TextureDescription& description, std::array<float, 2> range) {
  if (!has_value_range(description.type) || range[0] > range[1]) return {0.0F, 1.0F};
  for (const volume::Wrap wrap : description.wrap) {
    if (wrap != volume::Wrap::border || !std::isfinite(description.border[0])) continue;
    range[0] = std::min(range[0], description.border[0]);
    range[1] = std::max(range[1], description.border[0]);
  }
  if (description.steps > 0) return rounded_outwards(range, description.held, description.steps);
  // A constant field has no range to spread a table over: any range above it will do.
  if (range[0] == range[1]) range[1] += std::max(std::abs(range[1]), 1.0F);
  return range;
}

int table_entries(const TextureDescription& description, const std::array<float, 2>& range) {
  if (description.filter != volume::Filter::nearest || description.steps == 0) return probed_entries;
  return std::max(values_within(description, range) + 1, probed_entries);
}

bool may_lie_between_entries(const TextureDescription& description, const std::array<float, 2>& range,
                             int entries) {
  if (description.filter != volume::Filter::nearest) return false;
  if (description.steps == 0) return true;
  const int values = values_within(description, range);
  return values > 0 && (entries - 1) % values != 0;
}

}  // namespace understudy::spu
