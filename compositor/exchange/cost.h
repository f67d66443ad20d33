// SPDX-License-Identifier: Apache-2.0
// Estimates the cost of an exchange from its schedule, before anything is sent, and finds the cheapest one.
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
/// and `per_pixel` on each pixel that it blends or writes into the image buffer, in seconds. Ranks share
/// processors and connections: a round takes no less time than if `ranks_at_once` of them worked at a time.
struct MessageCost {
  double latency = 20e-6;
  double per_byte = 0.2e-9;
  double per_pixel = 2e-9;
  double ranks_at_once = std::numeric_limits<double>::infinity();
};

/// Whether packed pixels (pixel_numbers.h) arrive sooner: packing saves about seven bytes a pixel, and takes
/// the two sides about five nanoseconds for packing and unpacking.
constexpr bool packing_pays(const MessageCost& message_cost) {
  return 7 * message_cost.per_byte > 5e-9;
}

struct ExchangeCost {
  std::uint64_t messages = 0;
  std::uint64_t pixels_sent = 0;       ///< if all pixels of the rectangles are sent
  std::uint64_t bytes_sent = 0;        ///< of messages with these pixels
  std::uint64_t most_pixels_sent = 0;  ///< by any one rank
  double seconds = 0;                  ///< sum over the rounds
};

ExchangeCost cost(const Schedule& schedule, Layout layout, const MessageCost& message_cost);

/// Returns the cheapest schedule, after write_gathered(); among equals the first in the order of Algorithm.
Schedule cheapest(std::span<const Rank> order, std::span<const volume::Rect> footprints, Layout layout,
                  const MessageCost& message_cost, const std::vector<bool>& reached_by = {});

}  // namespace understudy::compositor
