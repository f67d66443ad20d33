// SPDX-License-Identifier: Apache-2.0
// Counts the bytes that an exchange sends, message by message, from the pixels that each rank has to show.
// Nothing is cast, blended or sent. (cost.h counts the same from footprints alone, as if all of their pixels
// were sent. Packed pixels are counted at their size before packing.)
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "compositor/exchange/pixel_layout.h"
#include "compositor/exchange/schedule.h"
#include "volume/blending_operator.h"
#include "volume/image.h"

namespace understudy::compositor {

/// Which pixels of a rectangle a sample has reached.
struct PixelMask {
  volume::Rect rect;
  std::vector<std::uint8_t> touched;  ///< 1 or 0 each; rows bottom up

  PixelMask() = default;
  explicit PixelMask(const volume::Rect& where) : rect(where), touched(where.pixels()) {}

  /// The row of pixels from (x, y) on, given in window coordinates inside `rect`.
  std::uint8_t* at(int x, int y) {
    return touched.data() + std::size_t(y - rect.y) * std::size_t(rect.width) + std::size_t(x - rect.x);
  }
  const std::uint8_t* at(int x, int y) const {
    return touched.data() + std::size_t(y - rect.y) * std::size_t(rect.width) + std::size_t(x - rect.x);
  }
};

/// Returns the pixels of a ray-cast image that differ from volume::neutral_value.
PixelMask mask_of(const volume::ImageView& image, volume::Operator op);

struct CountedMessage {
  Rank from = 0;
  Rank to = 0;
  std::uint64_t bytes = 0;
  std::uint64_t pixels = 0;  ///< that are sent in it
};

/// One rank's traffic in one round, or in all of them.
struct RankTraffic {
  std::uint64_t messages_sent = 0;
  std::uint64_t messages_received = 0;
  std::uint64_t bytes_sent = 0;
  std::uint64_t bytes_received = 0;
  std::uint64_t pixels_blended = 0;  ///< of all its pieces, if it has more than one
  std::uint64_t pixels_written = 0;  ///< into the image buffer

  RankTraffic& operator+=(const RankTraffic& other);
};

struct CountedRound {
  std::vector<CountedMessage> messages;  ///< in the order of the round's pieces
  std::vector<RankTraffic> ranks;
};

struct CountedExchange {
  std::vector<CountedRound> rounds;
  std::vector<RankTraffic> ranks;  ///< over all rounds
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;
};

/// `masks` are by rank, over the footprints that the schedule was made for. Exact for Layout::rgba32f. In
/// narrower layouts exact unless a touched pixel is so faint that all of its numbers round to those of an
/// untouched one, which is then not sent on. Throws std::invalid_argument if there is not one mask per rank.
CountedExchange counted_exchange(const Schedule& schedule, std::span<const PixelMask> masks,
                                 volume::Operator op, Layout layout);

}  // namespace understudy::compositor
