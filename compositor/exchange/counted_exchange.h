// SPDX-License-Identifier: Apache-2.0
// What an exchange sends to the byte, message by message, told from which pixels each rank has to show: nothing
// is cast, blended or sent. (cost.h counts the same from footprints alone, as if all of their pixels
// travelled. Of packed pixels it counts what they are before they are packed.)
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

/// Of an image as ray casters make it: where it is not volume::neutral_value.
PixelMask mask_of(const volume::ImageView& image, volume::Operator op);

struct CountedMessage {
  Rank from = 0;
  Rank to = 0;
  std::uint64_t bytes = 0;
  std::uint64_t pixels = 0;  ///< that travel in it
};

/// One rank's part in one round, or in all of them.
struct RankTraffic {
  std::uint64_t messages_sent = 0;
  std::uint64_t messages_received = 0;
  std::uint64_t bytes_sent = 0;
  std::uint64_t bytes_received = 0;
  std::uint64_t pixels_blended = 0;  ///< of all its pieces, where these are more than one
  std::uint64_t pixels_written = 0;  ///< into the image's memory

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

/// `masks` are by rank, over the footprints that the schedule was made for. Exact for Layout::rgba32f; in the
/// narrower ones as long as no touched pixel is so faint that all of its numbers round to those of an untouched
/// one, which then does not travel on. Throws std::invalid_argument when there are not as many masks as ranks.
CountedExchange counted_exchange(const Schedule& schedule, std::span<const PixelMask> masks,
                                 volume::Operator op, Layout layout);

}  // namespace understudy::compositor
