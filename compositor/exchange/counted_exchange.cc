// SPDX-License-Identifier: Apache-2.0
#include "compositor/exchange/counted_exchange.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "volume/raycast/ray_caster.h"

namespace understudy::compositor {

namespace {

using volume::Rect;

struct Runs {
  std::size_t runs = 0;
  std::size_t pixels = 0;  ///< that are sent in them
};

Runs runs_in(const PixelMask& mask, const Rect& rect, std::size_t least_hole) {
  Runs result;
  const auto width = std::size_t(rect.width);
  std::size_t next = 0;  // first pixel behind the last run
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    const std::uint8_t* const row = mask.at(rect.x, y);
    const std::size_t before = std::size_t(y - rect.y) * width;
    bool any = false;  // whether a pixel of this row is in a run
    for (std::size_t x = 0; x < width; ++x) {
      if (row[x] == 0) continue;
      const std::size_t at = before + x;
      const bool bridged = any && at - next < least_hole;
      if (!bridged && (result.runs == 0 || at > next)) ++result.runs;
      result.pixels += bridged ? at + 1 - next : 1;
      next = at + 1;
      any = true;
    }
  }
  return result;
}

/// Marks the pixels of `rect` that are touched in `from` as touched in `mask`, too.
void unite(PixelMask& mask, const PixelMask& from, const Rect& rect) {
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    const std::uint8_t* const source = from.at(rect.x, y);
    std::uint8_t* const row = mask.at(rect.x, y);
    for (std::size_t x = 0; x < std::size_t(rect.width); ++x) row[x] |= source[x];
  }
}

CountedMessage message_of(const Piece& piece, const PixelMask& mask, const Schedule& schedule,
                          volume::Operator op, Layout layout) {
  if (piece.written) return {piece.from, piece.to, head_bytes, 0};
  if (!may_travel_in_runs(piece.rect, op, layout, schedule.clear_pixels_travel))
    return {piece.from, piece.to, bytes_of_all_pixels(piece.rect, layout), piece.rect.pixels()};
  const Runs runs = runs_in(mask, piece.rect, least_hole(op, layout));
  return {piece.from, piece.to, head_bytes + bytes_per_run * runs.runs + bytes_per_pixel(layout) * runs.pixels,
          runs.pixels};
}

}  // namespace

RankTraffic& RankTraffic::operator+=(const RankTraffic& other) {
  messages_sent += other.messages_sent;
  messages_received += other.messages_received;
  bytes_sent += other.bytes_sent;
  bytes_received += other.bytes_received;
  pixels_blended += other.pixels_blended;
  pixels_written += other.pixels_written;
  return *this;
}

PixelMask mask_of(const volume::ImageView& image, volume::Operator op) {
  const float neutral = volume::neutral_value(op);
  PixelMask mask(image.rect);
  for (std::size_t i = 0; i < mask.touched.size(); ++i)
    mask.touched[i] =
        std::ranges::any_of(image.rgba.subspan(4 * i, 4), [&](float value) { return value != neutral; }) ? 1
                                                                                                         : 0;
  return mask;
}

CountedExchange counted_exchange(const Schedule& schedule, std::span<const PixelMask> masks,
                                 volume::Operator op, Layout layout) {
  const std::size_t ranks = schedule.position.size();
  if (masks.size() != ranks) throw std::invalid_argument("an exchange is counted from one mask for each rank");
  CountedExchange result;
  result.ranks.resize(ranks);
  std::vector<PixelMask> held(masks.begin(), masks.end());
  for (const Round& round : schedule.rounds) {
    CountedRound& counted = result.rounds.emplace_back();
    counted.ranks.resize(ranks);
    std::vector<PixelMask> next;
    next.reserve(ranks);
    for (const Rect& rect : round.afterwards) next.emplace_back(rect);
    std::vector<int> pieces_of(ranks);
    for (const Piece& piece : round.pieces) {
      const PixelMask& mask = held[std::size_t(piece.from)];
      RankTraffic& from = counted.ranks[std::size_t(piece.from)];
      RankTraffic& to = counted.ranks[std::size_t(piece.to)];
      if (piece.from != piece.to) {
        const CountedMessage& message =
            counted.messages.emplace_back(message_of(piece, mask, schedule, op, layout));
        ++from.messages_sent;
        ++to.messages_received;
        from.bytes_sent += message.bytes;
        to.bytes_received += message.bytes;
        ++result.messages;
        result.bytes += message.bytes;
      }
      if (piece.written) {
        from.pixels_written += piece.rect.pixels();
      } else {
        ++pieces_of[std::size_t(piece.to)];
        to.pixels_blended += piece.rect.pixels();
      }
      unite(next[std::size_t(piece.to)], mask, piece.rect);
    }
    for (std::size_t rank = 0; rank < ranks; ++rank) {
      if (pieces_of[rank] < 2) counted.ranks[rank].pixels_blended = 0;
      result.ranks[rank] += counted.ranks[rank];
    }
    held = std::move(next);
  }
  return result;
}

}  // namespace understudy::compositor
