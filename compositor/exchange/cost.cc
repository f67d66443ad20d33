// SPDX-License-Identifier: Apache-2.0
#include "compositor/exchange/cost.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace understudy::compositor {

namespace {

/// One rank's work in one round.
struct Work {
  std::uint64_t messages_out = 0, messages_in = 0, pixels_out = 0, pixels_in = 0, blended = 0, written = 0;
  int contributions = 0;
};

}  // namespace

ExchangeCost cost(const Schedule& schedule, Layout layout, const MessageCost& message_cost) {
  ExchangeCost result;
  std::vector<std::uint64_t> sent(schedule.position.size(), 0);
  bool written = false;
  for (const Round& round : schedule.rounds) {
    written = std::ranges::any_of(round.pieces, &Piece::written);
    std::vector<Work> work(schedule.position.size());
    for (const Piece& piece : round.pieces) {
      Work& to = work[std::size_t(piece.to)];
      Work& from = work[std::size_t(piece.from)];
      if (piece.from != piece.to) {
        ++from.messages_out;
        ++to.messages_in;
        ++result.messages;
      }
      if (piece.written) {
        from.written += piece.rect.pixels();
        if (piece.from != piece.to) result.bytes_sent += head_bytes;
        continue;
      }
      if (written) {
        to.written += piece.rect.pixels();
      } else {
        to.blended += piece.rect.pixels();
        ++to.contributions;
      }
      if (piece.from == piece.to) continue;
      from.pixels_out += piece.rect.pixels();
      to.pixels_in += piece.rect.pixels();
      result.pixels_sent += piece.rect.pixels();
      result.bytes_sent += bytes_of_all_pixels(piece.rect, layout);
      sent[std::size_t(piece.from)] += piece.rect.pixels();
    }
    double slowest = 0, together = 0;
    for (const Work& mine : work) {
      const double per_moved = message_cost.per_byte * double(bytes_per_pixel(layout));
      const double drawn =
          message_cost.per_pixel * double((mine.contributions > 1 ? mine.blended : 0) + mine.written);
      slowest = std::max(slowest, message_cost.latency * double(std::max(mine.messages_out, mine.messages_in)) +
                                      per_moved * double(std::max(mine.pixels_out, mine.pixels_in)) + drawn);
      // Half of a message's cost is the sender's work, half is the receiver's.
      together += message_cost.latency / 2 * double(mine.messages_out + mine.messages_in) +
                  per_moved / 2 * double(mine.pixels_out + mine.pixels_in) + drawn;
    }
    result.seconds += std::max(slowest, together / message_cost.ranks_at_once);
  }
  // Rank 0 then writes the whole image.
  if (!written) result.seconds += message_cost.per_pixel * double(schedule.whole.pixels());
  if (!sent.empty()) result.most_pixels_sent = *std::ranges::max_element(sent);
  return result;
}

Schedule cheapest(std::span<const Rank> order, std::span<const volume::Rect> footprints, Layout layout,
                  const MessageCost& message_cost, const std::vector<bool>& reached_by) {
  Schedule best;
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < algorithm_count; ++i) {
    Schedule candidate = schedule(Algorithm(i), order, footprints);
    write_gathered(candidate, reached_by);
    const double seconds = cost(candidate, layout, message_cost).seconds;
    if (seconds >= least) continue;
    least = seconds;
    best = std::move(candidate);
  }
  return best;
}

}  // namespace understudy::compositor
