#include "compositor/exchange/exchange.h"

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

#include "compositor/blend.h"
#include "volume/raycast/ray_caster.h"

namespace understudy::compositor {

namespace {

using volume::Image;
using volume::Rect;

Image part_of(const Image& image, const Rect& rect) {
  Image part(rect);
  for (int y = rect.y; y < rect.y + rect.height; ++y)
    std::memcpy(part.at(rect.x, y), image.at(rect.x, y), 4 * sizeof(float) * std::size_t(rect.width));
  return part;
}

/// `room` shows the pixels of `whole`.
void write_part(const Image& image, const Rect& rect, std::span<float> room, const Rect& whole) {
  for (int y = rect.y; y < rect.y + rect.height; ++y) {
    const std::size_t pixel =
        std::size_t(y - whole.y) * std::size_t(whole.width) + std::size_t(rect.x - whole.x);
    std::memcpy(room.data() + 4 * pixel, image.at(rect.x, y), 4 * sizeof(float) * std::size_t(rect.width));
  }
}

/// The parts of `rect` outside `hole`: below, above, left and right of it.
void add_around(const Rect& rect, const Rect& hole, std::vector<Rect>& parts) {
  const Rect common = intersection(rect, hole);
  if (common.empty()) return parts.push_back(rect);
  const int right = common.x + common.width, top = common.y + common.height;
  for (const Rect& part : {Rect{rect.x, rect.y, rect.width, common.y - rect.y},
                           Rect{rect.x, top, rect.width, rect.y + rect.height - top},
                           Rect{rect.x, common.y, common.x - rect.x, common.height},
                           Rect{right, common.y, rect.x + rect.width - right, common.height}})
    if (!part.empty()) parts.push_back(part);
}

/// One rank's way through a schedule.
class Player {
 public:
  Player(Image mine, const Schedule& schedule, volume::Operator op, Layout layout, Link& link,
         std::span<float> memory)
      : image_(std::move(mine)), schedule_(schedule), op_(op), layout_(layout), link_(link), memory_(memory) {}

  void play(const Round& round) {
    const Rank me = link_.rank();
    std::vector<const Piece*> given, arriving;
    const Piece* kept = nullptr;
    for (const Piece& piece : round.pieces) {
      if (piece.from == me && piece.to == me)
        kept = &piece;
      else if (piece.from == me)
        given.push_back(&piece);
      else if (piece.to == me)
        arriving.push_back(&piece);
    }
    if (given.empty() && arriving.empty()) return;

    std::vector<PixelMessage> messages;
    std::vector<Outgoing> outgoing;
    messages.reserve(given.size());
    outgoing.reserve(given.size());
    for (const Piece* piece : given) {
      if (piece->written) {
        write_part(image_, piece->rect, memory_, schedule_.whole);
        messages.emplace_back(head_bytes);
      } else {
        messages.push_back(encode_pixels(image_, piece->rect, op_, layout_, schedule_.clear_pixels_travel));
      }
      bytes_to_tell_ += messages.back().size();
    }
    if (!messages.empty()) messages.front().tell(std::exchange(bytes_to_tell_, 0));
    for (std::size_t i = 0; i < given.size(); ++i) outgoing.push_back({given[i]->to, messages[i].bytes()});

    std::vector<PixelMessage> arrived;
    std::vector<Incoming> incoming;
    arrived.reserve(arriving.size());
    for (const Piece* piece : arriving) {
      PixelMessage& room = arrived.emplace_back(piece->written ? PixelMessage(head_bytes)
                                                               : room_for_pixels(piece->rect, layout_));
      incoming.push_back({piece->from, room.room(), &room.received()});
    }
    link_.transfer(outgoing, incoming);

    for (const PixelMessage& message : arrived) bytes_to_tell_ += message.told();
    if (me == 0 && std::ranges::any_of(round.pieces, &Piece::written)) {
      if (kept != nullptr) write_part(image_, kept->rect, memory_, schedule_.whole);
      for (std::size_t i = 0; i < arriving.size(); ++i)
        if (const Rect& rect = arriving[i]->rect; !arriving[i]->written)
          write_part(decode_pixels(arrived[i], rect, op_, layout_), rect, memory_, schedule_.whole);
      clear_between(round);
      written_ = true;
      return;
    }

    std::vector<Contribution> contributions;
    if (kept != nullptr) contributions.push_back({schedule_.position[std::size_t(me)], {}, kept->rect});
    for (std::size_t i = 0; i < arriving.size(); ++i) {
      contributions.push_back({schedule_.position[std::size_t(arriving[i]->from)],
                               decode_pixels(arrived[i], arriving[i]->rect, op_, layout_), arriving[i]->rect});
      arrived[i] = {};
    }
    blend_all(contributions, round.afterwards[std::size_t(me)]);
  }

  Exchanged finish() && {
    if (link_.rank() != 0) return {};
    if (memory_.empty()) return {std::move(image_), bytes_to_tell_};
    if (!written_ && !schedule_.whole.empty()) write_part(image_, image_.rect, memory_, schedule_.whole);
    return {{}, bytes_to_tell_};
  }

 private:
  struct Contribution {
    int position = 0;
    Image image;  ///< without pixels: the part of this rank's own image
    Rect rect;
  };

  /// What no piece of the last round covers has been reached by no sample.
  void clear_between(const Round& round) {
    std::vector<Rect> bare{schedule_.whole};
    for (const Piece& piece : round.pieces) {
      std::vector<Rect> left;
      for (const Rect& rect : bare) add_around(rect, piece.rect, left);
      bare = std::move(left);
    }
    const float neutral = volume::neutral_value(op_);
    for (const Rect& rect : bare)
      for (int y = rect.y; y < rect.y + rect.height; ++y) {
        const std::size_t pixel = std::size_t(y - schedule_.whole.y) * std::size_t(schedule_.whole.width) +
                                  std::size_t(rect.x - schedule_.whole.x);
        std::fill_n(memory_.begin() + std::ptrdiff_t(4 * pixel), 4 * std::size_t(rect.width), neutral);
      }
  }

  void blend_all(std::vector<Contribution>& contributions, const Rect& afterwards) {
    if (contributions.size() == 1) {
      Contribution& only = contributions.front();
      if (!only.image.rgba.empty())
        image_ = std::move(only.image);
      else if (only.rect != image_.rect)
        image_ = part_of(image_, only.rect);
      return;
    }
    std::ranges::sort(contributions, {}, &Contribution::position);
    Image result(afterwards);
    if (const float value = volume::neutral_value(op_); value != 0) std::ranges::fill(result.rgba, value);
    for (const Contribution& contribution : contributions) {
      const bool own = contribution.image.rgba.empty();
      // Of this rank's own image only the part that it kept counts.
      if (own && contribution.rect != image_.rect)
        blend(op_, result, part_of(image_, contribution.rect).view());
      else
        blend(op_, result, own ? image_.view() : contribution.image.view());
    }
    image_ = std::move(result);
  }

  Image image_;
  const Schedule& schedule_;
  volume::Operator op_;
  Layout layout_;
  Link& link_;
  std::span<float> memory_;
  bool written_ = false;             // the picture is in the memory
  std::uint64_t bytes_to_tell_ = 0;  // that rank 0 has not heard of
};

}  // namespace

Exchanged exchange(Image mine, const Schedule& schedule, volume::Operator op, Layout layout, Link& link,
                   std::span<float> memory) {
  Player player(std::move(mine), schedule, op, layout, link, memory);
  for (const Round& round : schedule.rounds) player.play(round);
  return std::move(player).finish();
}

}  // namespace understudy::compositor
