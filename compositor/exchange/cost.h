// SPDX-License-Identifier: Apache-2.0
// What an exchange will cost, counted from its schedule before anything is sent; and which one costs least.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "compositor/exchange/pixel_layout.h"
#include "compositor/exchange/schedule.h"
#include "volume/rect.h"

namespace understudy::compositor {

/// A LogP-like model: a rank spends `latency` on each message, `per_byte` on each byte in the busier direction,
/// and `per_pixel` on each pixel that it blends or writes into the image's memory, in seconds. Ranks share
/// processors and lines: what all of them do in a round takes no less than if `ranks_at_once` of them got on.
struct MessageCost {
  double latency = 20e-6;
  double per_byte = 0.2e-9;
  double per_pixel = 2e-9;
  double ranks_at_once = std::numeric_limits<double>::infinity();
};

/// Whether packed pixels (pixel_numbers.h) arrive sooner: where lines take longer for what packing saves, about
/// seven bytes a pixel, than the two sides for packing and unpacking, about five nanoseconds.
constexpr bool packing_pays(const MessageCost& message_cost) {
  return 7 * message_cost.per_byte > 5e-9;
}

struct ExchangeCost {
  std::uint64_t messages = 0;
  std::uint64_t pixels_sent = 0;       ///< that travel, when all pixels of the rectangles do
  std::uint64_t bytes_sent = 0;        ///< in which these do
  std::uint64_t most_pixels_sent = 0;  ///< by any one rank
  double seconds = 0;                  ///< rounds one after the other
};

ExchangeCost cost(const Schedule& schedule, Layout layout, const MessageCost& message_cost);

/// The schedule that costs least, after write_gathered(); among equals the first in the order of Algorithm.
Schedule cheapest(std::span<const Rank> order, std::span<const volume::Rect> footprints, Layout layout,
                  const MessageCost& message_cost, const std::vector<bool>& reached_by = {});

}  // namespace understudy::compositor
