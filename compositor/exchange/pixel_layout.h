// SPDX-License-Identifier: Apache-2.0
// How the pixels of a rectangle are sent between ranks: in which numbers, and which pixels at all.
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

/// Length of the head, before the pixels of a message.
constexpr std::size_t head_bytes = 16;

/// Messages that might be longer have a length that both sides know beforehand: all pixels are sent, as floats.
constexpr std::size_t longest_of_unknown_length = std::size_t(1) << 30;

/// Whether the length of messages about `rect` depends on their content.
inline bool of_unknown_length(const volume::Rect& rect) {
  return 2 * head_bytes + most_packed_bytes(rect.pixels()) + 4 * rect.pixels() <= longest_of_unknown_length;
}

/// Returns the length of a message with all pixels of `rect`, unpacked. (Under `min`, narrow numbers are always
/// sent in runs, which take up to 8 bytes more for every two pixels.)
inline std::size_t bytes_of_all_pixels(const volume::Rect& rect, Layout layout) {
  return head_bytes + bytes_per_pixel(of_unknown_length(rect) ? layout : Layout::rgba32f) * rect.pixels();
}

/// Runs follow the pixels of a message: for each run the number of untouched pixels, then of pixels that are
/// sent; runs continue from row to row.
constexpr std::size_t bytes_per_run = 8;

/// Narrow numbers cannot represent an untouched pixel under `min`.
inline bool must_travel_in_runs(volume::Operator op, Layout layout) {
  return op == volume::Operator::min && layout != Layout::rgba32f;
}

/// Whether a message about `rect` may omit pixels.
inline bool may_travel_in_runs(const volume::Rect& rect, volume::Operator op, Layout layout, bool clear_too) {
  return of_unknown_length(rect) && (!clear_too || must_travel_in_runs(op, layout));
}

/// Shorter holes in a row are sent, too: another run would take more bytes.
inline std::size_t least_hole(volume::Operator op, Layout layout) {
  constexpr std::size_t least_saving = 32;  // bytes
  return must_travel_in_runs(op, layout) ? 1 : least_saving / bytes_per_pixel(layout);
}

/// An outgoing or incoming message.
class PixelMessage {
 public:
  PixelMessage() = default;
  explicit PixelMessage(std::size_t room)
      : own_(std::make_unique_for_overwrite<std::byte[]>(room)), room_(own_.get(), room), bytes_(room_) {}
  /// In memory that the caller owns.
  explicit PixelMessage(std::span<std::byte> room) : room_(room), bytes_(room) {}

  std::size_t size() const { return bytes_.size(); }
  std::span<const std::byte> bytes() const { return bytes_; }
  std::span<std::byte> room() { return room_; }
  /// Shortens an outgoing message to `size`, if it fills less than its room.
  void shorten(std::size_t size) { bytes_ = bytes_.first(size); }
  /// Set to where the message is, if it stays in its sender's memory.
  std::span<const std::byte>& seen() { return bytes_; }
  /// How many bytes of the room were filled.
  std::size_t& received() { return received_; }
  std::size_t received() const { return received_; }

  /// A count that is sent along: bytes that the sender knows to have been sent.
  void tell(std::uint64_t count);
  std::uint64_t told() const;

 private:
  std::unique_ptr<std::byte[]> own_;
  std::span<std::byte> room_;
  std::span<const std::byte> bytes_;
  std::size_t received_ = 0;
};

/// Encodes the pixels of `image` in `rect`, which lies inside it. Unless `clear_too` is set, only pixels that a
/// sample has reached (volume::neutral_value) are sent, in runs, and packed if `packed` is set. The message is
/// made in `room` if that is large enough for any message.
PixelMessage encode_pixels(const volume::Image& image, const volume::Rect& rect, volume::Operator op,
                           Layout layout, bool packed, bool clear_too = false, std::span<std::byte> room = {});

/// The length of the longest message about this rectangle, and memory for it.
std::size_t most_message_bytes(const volume::Rect& rect, Layout layout);
PixelMessage space_for_pixels(const volume::Rect& rect, Layout layout);

/// Reads the pixels of a message that has arrived in such memory, row by row.
class PixelReader {
 public:
  /// `message` must outlive the reader. Throws RankLost if it is malformed.
  PixelReader(const PixelMessage& message, const volume::Rect& rect, Layout layout);

  const volume::Rect& rect() const { return rect_; }

  /// Reads the next row of the rectangle into `row`: sets the pixels that were sent, and leaves the others
  /// unchanged. Throws RankLost if the message ends early, as the following functions do.
  void read_row(std::span<float> row);
  /// Blends the next row behind `row`.
  void blend_row_behind(volume::Operator op, std::span<float> row);
  /// To be called after the last row: throws if the message holds more.
  void end() const;

 private:
  template <class Use>
  void for_spans(std::span<float> row, Use use);
  void next_pixels(std::span<float> pixels);

  volume::Rect rect_;
  Layout layout_;
  bool packed_ = false;
  std::span<const std::byte> pixels_, runs_;  // not read yet
  LastPixel last_{};
  std::size_t untouched_ = 0, touched_ = 0;  // left of the current run
};

}  // namespace understudy::compositor
