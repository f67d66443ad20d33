// SPDX-License-Identifier: Apache-2.0
// How the pixels of a rectangle travel between ranks: which numbers, and which pixels at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "compositor/exchange/pixel_numbers.h"
#include "compositor/exchange/settings.h"
#include "volume/blending_operator.h"
#include "volume/image.h"

namespace understudy::compositor {

/// Before the pixels of a message.
constexpr std::size_t head_bytes = 16;

/// Longer messages have a length that both sides know beforehand: all pixels travel, as floats.
constexpr std::size_t longest_of_unknown_length = std::size_t(1) << 30;

/// Whether messages about `rect` are as long as their content asks for.
inline bool of_unknown_length(const volume::Rect& rect) {
  return 2 * head_bytes + most_packed_bytes(rect.pixels()) + 4 * rect.pixels() <= longest_of_unknown_length;
}

/// The length of a message with all pixels of `rect` and nothing gained by packing them. (Under `min` narrow
/// numbers always travel in runs, and take up to 8 bytes for every two pixels more.)
inline std::size_t bytes_of_all_pixels(const volume::Rect& rect, Layout layout) {
  return head_bytes + bytes_per_pixel(of_unknown_length(rect) ? layout : Layout::rgba32f) * rect.pixels();
}

/// Behind the pixels of a message: for each run so many pixels untouched, then so many that travel; runs go on
/// from row to row.
constexpr std::size_t bytes_per_run = 8;

/// Narrow numbers have none for an untouched pixel under `min`.
inline bool must_travel_in_runs(volume::Operator op, Layout layout) {
  return op == volume::Operator::min && layout != Layout::rgba32f;
}

/// Whether a message about `rect` may leave pixels out.
inline bool may_travel_in_runs(const volume::Rect& rect, volume::Operator op, Layout layout, bool clear_too) {
  return of_unknown_length(rect) && (!clear_too || must_travel_in_runs(op, layout));
}

/// Untouched pixels of a row, fewer than so many in a line, travel all the same: a run would take more.
inline std::size_t least_hole(volume::Operator op, Layout layout) {
  constexpr std::size_t least_saving = 32;  // bytes
  return must_travel_in_runs(op, layout) ? 1 : least_saving / bytes_per_pixel(layout);
}

/// One message, on its way out or on its way in.
class PixelMessage {
 public:
  PixelMessage() = default;
  explicit PixelMessage(std::size_t room)
      : own_(std::make_unique_for_overwrite<std::byte[]>(room)), room_(own_.get(), room), bytes_(room_) {}
  /// In memory of somebody else's, who keeps it.
  explicit PixelMessage(std::span<std::byte> room) : room_(room), bytes_(room) {}

  std::size_t size() const { return bytes_.size(); }
  std::span<const std::byte> bytes() const { return bytes_; }
  std::span<std::byte> room() { return room_; }
  /// Less than there was room for is the message.
  void shorten(std::size_t size) { bytes_ = bytes_.first(size); }
  /// Where the message is if it has stayed elsewhere.
  std::span<const std::byte>& seen() { return bytes_; }
  /// How much of the room was filled.
  std::size_t& received() { return received_; }
  std::size_t received() const { return received_; }

  /// A count that travels along: of bytes that the sender knows to have travelled.
  void tell(std::uint64_t count);
  std::uint64_t told() const;

 private:
  std::unique_ptr<std::byte[]> own_;
  std::span<std::byte> room_;
  std::span<const std::byte> bytes_;
  std::size_t received_ = 0;
};

/// The pixels of `image` in `rect`, which lies inside it. Unless `clear_too` is asked for, only those that a
/// sample has reached (volume::neutral_value) travel, in runs, and packed if that is asked for. `room` is where
/// the message is made if it is long enough for any.
PixelMessage encode_pixels(const volume::Image& image, const volume::Rect& rect, volume::Operator op,
                           Layout layout, bool packed, bool clear_too = false, std::span<std::byte> room = {});

/// The longest message about this rectangle, and room for it.
std::size_t most_message_bytes(const volume::Rect& rect, Layout layout);
PixelMessage space_for_pixels(const volume::Rect& rect, Layout layout);

/// Goes through the pixels of a message that has come in such memory, row by row.
class PixelReader {
 public:
  /// `message` outlives it. Throws RankLost when it is no such message.
  PixelReader(const PixelMessage& message, const volume::Rect& rect, Layout layout);

  const volume::Rect& rect() const { return rect_; }

  /// The next row of the rectangle, which is `row`: sets the pixels that came, and leaves all others alone.
  /// Throws RankLost when the message ends before; so do the others.
  void read_row(std::span<float> row);
  /// Blends the next row behind `row`.
  void blend_row_behind(volume::Operator op, std::span<float> row);
  /// After the last row: throws when the message holds more.
  void end() const;

 private:
  template <class Use>
  void for_spans(std::span<float> row, Use use);
  void next_pixels(std::span<float> pixels);

  volume::Rect rect_;
  Layout layout_;
  bool packed_ = false;
  std::span<const std::byte> pixels_, runs_;  // that are left
  LastPixel last_{};
  std::size_t untouched_ = 0, touched_ = 0;  // of the run that is open
};

}  // namespace understudy::compositor
