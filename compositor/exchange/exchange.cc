// SPDX-License-Identifier: Apache-2.0
#include "compositor/exchange/exchange.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <span>
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

/// Adds the parts of `rect` outside `hole`: below, above, left and right of it.
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

/// Executes a schedule on one rank.
class Player {
 public:
  Player(Image mine, const Schedule& schedule, volume::Operator op, Layout layout, Communicator& communicator,
         std::span<float> memory)
      : image_(std::move(mine)),
        schedule_(schedule),
        op_(op),
        layout_(layout),
        communicator_(communicator),
        memory_(memory) {}

  void play(const Round& round) {
    const Mine mine = mine_of(round);
    if (mine.given.empty() && mine.arriving.empty()) return;
    std::vector<PixelMessage> arrived = transferred(mine);
    if (communicator_.rank() == 0 && std::ranges::any_of(round.pieces, &Piece::written))
      write_round(round, mine, arrived);
    else
      blend_round(round, mine, arrived);
  }

  Exchanged finish() && {
    if (communicator_.rank() != 0) return {};
    if (memory_.empty()) return {std::move(image_), bytes_to_tell_};
    if (!written_ && !schedule_.whole.empty()) {
      write_part(image_.rect);
      clear_between({&image_.rect, 1});
    }
    return {{}, bytes_to_tell_};
  }

 private:
  /// This rank's part in a round.
  struct Mine {
    std::vector<const Piece*> given, arriving;
    const Piece* kept = nullptr;
  };

  Mine mine_of(const Round& round) const {
    const Rank me = communicator_.rank();
    Mine mine;
    for (const Piece& piece : round.pieces) {
      if (piece.from == me && piece.to == me)
        mine.kept = &piece;
      else if (piece.from == me)
        mine.given.push_back(&piece);
      else if (piece.to == me)
        mine.arriving.push_back(&piece);
    }
    return mine;
  }

  /// Encodes the given pieces as messages. Of pieces written into the image buffer only a head is sent.
  std::vector<PixelMessage> encoded(const std::vector<const Piece*>& given) {
    std::vector<PixelMessage> messages;
    messages.reserve(given.size());
    for (const Piece* piece : given) {
      if (piece->written) {
        write_part(piece->rect);
        const std::span<std::byte> shared = communicator_.shared_segment(head_bytes);
        PixelMessage& written =
            messages.emplace_back(shared.empty() ? PixelMessage(head_bytes) : PixelMessage(shared));
        std::ranges::fill(written.room(), std::byte(0));
      } else {
        messages.push_back(
            encode_pixels(image_, piece->rect, op_, layout_, schedule_.packed, schedule_.clear_pixels_travel,
                          communicator_.shared_segment(most_message_bytes(piece->rect, layout_))));
      }
      bytes_to_tell_ += messages.back().size();
    }
    if (!messages.empty()) messages.front().tell(std::exchange(bytes_to_tell_, 0));
    return messages;
  }

  /// Sends the given pieces; returns the messages that arrive.
  std::vector<PixelMessage> transferred(const Mine& mine) {
    std::vector<PixelMessage> messages = encoded(mine.given);
    std::vector<Outgoing> outgoing;
    outgoing.reserve(messages.size());
    for (std::size_t i = 0; i < messages.size(); ++i)
      outgoing.push_back({mine.given[i]->to, messages[i].bytes(), true});

    std::vector<PixelMessage> arrived;
    std::vector<Incoming> incoming;
    arrived.reserve(mine.arriving.size());
    for (const Piece* piece : mine.arriving) {
      PixelMessage& room = arrived.emplace_back(piece->written ? PixelMessage(head_bytes)
                                                               : space_for_pixels(piece->rect, layout_));
      incoming.push_back({piece->from, room.room(), &room.received(), &room.seen()});
    }
    communicator_.transfer(outgoing, incoming);
    for (const PixelMessage& message : arrived) bytes_to_tell_ += message.told();
    return arrived;
  }

  /// Rank 0's last round, if ranks write into the image buffer.
  void write_round(const Round& round, const Mine& mine, std::vector<PixelMessage>& arrived) {
    if (mine.kept != nullptr) write_part(mine.kept->rect);
    for (std::size_t i = 0; i < arrived.size(); ++i)
      if (!mine.arriving[i]->written) write_arrived(PixelReader(arrived[i], mine.arriving[i]->rect, layout_));
    std::vector<Rect> pieces;
    for (const Piece& piece : round.pieces) pieces.push_back(piece.rect);
    clear_between(pieces);
    written_ = true;
  }

  void blend_round(const Round& round, const Mine& mine, std::vector<PixelMessage>& arrived) {
    const auto me = std::size_t(communicator_.rank());
    std::vector<Contribution> contributions;
    if (mine.kept != nullptr) contributions.push_back({schedule_.position[me], mine.kept->rect, {}});
    for (std::size_t i = 0; i < arrived.size(); ++i) {
      contributions.push_back({schedule_.position[std::size_t(mine.arriving[i]->from)], mine.arriving[i]->rect,
                               PixelReader(arrived[i], mine.arriving[i]->rect, layout_)});
    }
    blend_all(contributions, round.afterwards[me]);
  }

  struct Contribution {
    int position = 0;
    Rect rect;
    std::optional<PixelReader> arrived;  ///< null: the part of this rank's own image
  };

  /// A row of pixels from (x, y) on, in the image buffer.
  std::span<float> in_memory(int x, int y, int pixels) const {
    const Rect& whole = schedule_.whole;
    const std::size_t first = std::size_t(y - whole.y) * std::size_t(whole.width) + std::size_t(x - whole.x);
    return memory_.subspan(4 * first, 4 * std::size_t(pixels));
  }

  void write_part(const Rect& rect) {
    for (int y = rect.y; y < rect.y + rect.height; ++y)
      std::copy_n(image_.at(rect.x, y), 4 * std::size_t(rect.width), in_memory(rect.x, y, rect.width).begin());
  }

  void write_arrived(PixelReader arrived) {
    const Rect rect = arrived.rect();
    for (int y = rect.y; y < rect.y + rect.height; ++y) {
      const std::span<float> row = in_memory(rect.x, y, rect.width);
      std::ranges::fill(row, volume::neutral_value(op_));
      arrived.read_row(row);
    }
    arrived.end();
  }

  /// Clears the pixels that none of these covers: no sample has reached them.
  void clear_between(std::span<const Rect> covered) {
    std::vector<Rect> bare{schedule_.whole};
    for (const Rect& hole : covered) {
      std::vector<Rect> left;
      for (const Rect& rect : bare) add_around(rect, hole, left);
      bare = std::move(left);
    }
    for (const Rect& rect : bare)
      for (int y = rect.y; y < rect.y + rect.height; ++y)
        std::ranges::fill(in_memory(rect.x, y, rect.width), volume::neutral_value(op_));
  }

  void blend_all(std::vector<Contribution>& contributions, const Rect& afterwards) {
    if (contributions.size() == 1 && !contributions.front().arrived) {
      if (afterwards != image_.rect) image_ = part_of(image_, afterwards);
      return;
    }
    std::ranges::sort(contributions, {}, &Contribution::position);
    if (!contributions.empty() && !contributions.front().arrived && image_.rect == afterwards &&
        contributions.front().rect == afterwards)
      blend_behind_own(std::span(contributions).subspan(1));
    else
      blend_anew(contributions, afterwards);
    for (const Contribution& contribution : contributions)
      if (contribution.arrived) contribution.arrived->end();
  }

  // Blends everything else behind this rank's own image, within its rectangle.
  void blend_behind_own(std::span<Contribution> others) {
    for (int y = image_.rect.y; y < image_.rect.y + image_.rect.height; ++y)
      for (Contribution& other : others)
        if (has_row(other.rect, y))
          other.arrived->blend_row_behind(op_, {image_.at(other.rect.x, y), 4 * std::size_t(other.rect.width)});
  }

  // Blends row by row, so that a row stays in the nearest cache and an image is written once.
  void blend_anew(std::span<Contribution> contributions, const Rect& afterwards) {
    const std::size_t floats = 4 * std::size_t(afterwards.width);
    const float neutral = volume::neutral_value(op_);
    // This rank's own part of a row is already blended when the row is overwritten.
    const bool in_place = image_.rect == afterwards;
    Image result;
    result.rgba.reserve(in_place ? floats : 4 * afterwards.pixels());
    for (int y = afterwards.y; y < afterwards.y + afterwards.height; ++y) {
      if (in_place) result.rgba.clear();
      result.rgba.resize(result.rgba.size() + floats, neutral);
      const std::span<float> row = std::span(result.rgba).last(floats);
      blend_row(contributions, y, afterwards.x, row);
      if (in_place) std::ranges::copy(row, image_.at(afterwards.x, y));
    }
    if (in_place) return;
    result.rect = afterwards;
    image_ = std::move(result);
  }

  // Blends all contributions to a row that begins at x; the row is neutral before.
  void blend_row(std::span<Contribution> contributions, int y, int x, std::span<float> row) {
    bool first = true;
    for (Contribution& contribution : contributions) {
      const Rect& rect = contribution.rect;
      if (!has_row(rect, y)) continue;
      const std::span<float> here = row.subspan(4 * std::size_t(rect.x - x), 4 * std::size_t(rect.width));
      if (contribution.arrived && first)
        contribution.arrived->read_row(here);
      else if (contribution.arrived)
        contribution.arrived->blend_row_behind(op_, here);
      else
        blend(op_, here, {image_.at(rect.x, y), here.size()});
      first = false;
    }
  }

  static bool has_row(const Rect& rect, int y) { return y >= rect.y && y < rect.y + rect.height; }

  Image image_;
  const Schedule& schedule_;
  volume::Operator op_;
  Layout layout_;
  Communicator& communicator_;
  std::span<float> memory_;
  bool written_ = false;             // the image buffer holds the image
  std::uint64_t bytes_to_tell_ = 0;  // that rank 0 has not been told of
};

}  // namespace

Exchanged exchange(Image mine, const Schedule& schedule, volume::Operator op, Layout layout,
                   Communicator& communicator, std::span<float> memory) {
  Player player(std::move(mine), schedule, op, layout, communicator, memory);
  for (const Round& round : schedule.rounds) player.play(round);
  return std::move(player).finish();
}

}  // namespace understudy::compositor
