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

/// One rank's way through a schedule.
class Player {
 public:
  Player(Image mine, const Schedule& schedule, volume::Operator op, Layout layout, Link& link)
      : image_(std::move(mine)), schedule_(schedule), op_(op), layout_(layout), link_(link) {}

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
      messages.push_back(encode_pixels(image_, piece->rect, op_, layout_, schedule_.clear_pixels_travel));
      bytes_to_tell_ += messages.back().size();
    }
    if (!messages.empty()) messages.front().tell(std::exchange(bytes_to_tell_, 0));
    for (std::size_t i = 0; i < given.size(); ++i) outgoing.push_back({given[i]->to, messages[i].bytes()});

    std::vector<PixelMessage> arrived;
    std::vector<Incoming> incoming;
    arrived.reserve(arriving.size());
    for (const Piece* piece : arriving) {
      PixelMessage& room = arrived.emplace_back(room_for_pixels(piece->rect, layout_));
      incoming.push_back({piece->from, room.room(), &room.received()});
    }
    link_.transfer(outgoing, incoming);

    std::vector<Contribution> contributions;
    if (kept != nullptr) contributions.push_back({schedule_.position[std::size_t(me)], {}, kept->rect});
    for (std::size_t i = 0; i < arriving.size(); ++i) {
      bytes_to_tell_ += arrived[i].told();
      contributions.push_back({schedule_.position[std::size_t(arriving[i]->from)],
                               decode_pixels(arrived[i], arriving[i]->rect, op_, layout_), arriving[i]->rect});
      arrived[i] = {};
    }
    blend_all(contributions, round.afterwards[std::size_t(me)]);
  }

  Exchanged finish() && {
    if (link_.rank() != 0) return {};
    return {std::move(image_), bytes_to_tell_};
  }

 private:
  struct Contribution {
    int position = 0;
    Image image;  ///< without pixels: the part of this rank's own image
    Rect rect;
  };

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
  std::uint64_t bytes_to_tell_ = 0;  // that rank 0 has not heard of
};

}  // namespace

Exchanged exchange(Image mine, const Schedule& schedule, volume::Operator op, Layout layout, Link& link) {
  Player player(std::move(mine), schedule, op, layout, link);
  for (const Round& round : schedule.rounds) player.play(round);
  return std::move(player).finish();
}

}  // namespace understudy::compositor
