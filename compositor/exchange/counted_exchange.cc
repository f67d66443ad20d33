#include "compositor/exchange/counted_exchange.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "volume/raycast/ray_caster.h"

namespace understudy::compositor {

namespace {

using volume::Rect;

struct Runs {
  std::size_t runs = 1;
  std::size_t touched = 0;
};

Runs runs_in(const PixelMask& mask, const Rect& rect) {
  Runs result;
  const auto width = std::size_t(rect.width);
  std::uint8_t before = 0;
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    const std::uint8_t* const row = mask.at(rect.x, y);
    // A run begins where an untouched pixel follows a touched one.
    std::size_t touched = row[0], begun = row[0] < before;
    for (std::size_t x = 1; x < width; ++x) {
      touched += row[x];
      begun += row[x] < row[x - 1];
    }
    before = row[width - 1];
    result.touched += touched;
    result.runs += begun;
  }
  return result;
}

/// What of `from` lies in `rect` is touched in `mask`, too.
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
  const Runs runs = runs_in(mask, piece.rect);
  const MessageLength length =
      message_length(piece.rect, op, layout, schedule.clear_pixels_travel, runs.runs, runs.touched);
  return {piece.from, piece.to, length.bytes, length.in_runs ? runs.touched : piece.rect.pixels()};
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
