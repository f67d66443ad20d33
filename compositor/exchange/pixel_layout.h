// How the pixels of a rectangle travel between ranks: which numbers, and which pixels at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "compositor/exchange/settings.h"
#include "volume/image.h"
#include "volume/request.h"

namespace understudy::compositor {

constexpr std::size_t bytes_per_pixel(Layout layout) {
  return layout == Layout::rgba32f ? 16 : layout == Layout::rgba16f ? 8 : 4;
}

/// Before the pixels of a message.
constexpr std::size_t head_bytes = 12;

/// Longer messages have a length that both sides know beforehand: all pixels travel, as floats.
constexpr std::size_t longest_of_unknown_length = std::size_t(1) << 30;

/// The length of a message with all pixels of `rect`. (Under `min` narrow numbers always travel in runs, and
/// take up to 8 bytes for every two pixels more.)
inline std::size_t bytes_of_all_pixels(const volume::Rect& rect, Layout layout) {
  const std::size_t as_floats = head_bytes + bytes_per_pixel(Layout::rgba32f) * rect.pixels();
  return as_floats > longest_of_unknown_length ? as_floats
                                               : head_bytes + bytes_per_pixel(layout) * rect.pixels();
}

/// Before the pixels of a message in runs: for each so many pixels untouched, then so many that travel; runs go
/// on from row to row, and there is always one, if of nothing.
constexpr std::size_t bytes_per_run = 8;

/// Narrow numbers have none for an untouched pixel under `min`.
inline bool must_travel_in_runs(volume::Operator op, Layout layout) {
  return op == volume::Operator::min && layout != Layout::rgba32f;
}

/// Whether a message about `rect` may leave pixels out.
inline bool may_travel_in_runs(const volume::Rect& rect, volume::Operator op, Layout layout, bool clear_too) {
  return bytes_of_all_pixels(rect, Layout::rgba32f) <= longest_of_unknown_length &&
         (!clear_too || must_travel_in_runs(op, layout));
}

struct MessageLength {
  std::size_t bytes = 0;
  bool in_runs = false;  ///< only touched pixels travel; else all of them
};

/// What encode_pixels() makes of a rectangle of whose pixels `touched` are touched, in `runs` runs. Where
/// nothing may be left out, neither is looked at.
inline MessageLength message_length(const volume::Rect& rect, volume::Operator op, Layout layout,
                                    bool clear_too, std::size_t runs, std::size_t touched) {
  const std::size_t all = bytes_of_all_pixels(rect, layout);
  if (!may_travel_in_runs(rect, op, layout, clear_too)) return {all, false};
  const std::size_t in_runs = head_bytes + bytes_per_run * runs + bytes_per_pixel(layout) * touched;
  if (must_travel_in_runs(op, layout) || in_runs < all) return {in_runs, true};
  return {all, false};
}

/// One message, on its way out or on its way in.
class PixelMessage {
 public:
  PixelMessage() = default;
  explicit PixelMessage(std::size_t room) : bytes_(room) {}

  std::size_t size() const { return bytes_.size(); }
  std::span<const std::byte> bytes() const { return bytes_; }
  std::span<std::byte> room() { return bytes_; }
  /// How much of the room was filled.
  std::size_t& received() { return received_; }

  /// A count that travels along: of bytes that the sender knows to have travelled.
  void tell(std::uint64_t count);
  std::uint64_t told() const;

 private:
  std::vector<std::byte> bytes_;
  std::size_t received_ = 0;
};

/// The pixels of `image` in `rect`, which lies inside it. Where that is shorter, and `clear_too` is not asked
/// for, only those that a sample has reached (volume::neutral_value) travel, in runs.
PixelMessage encode_pixels(const volume::Image& image, const volume::Rect& rect, volume::Operator op,
                           Layout layout, bool clear_too = false);

/// Room for the longest message about this rectangle.
PixelMessage room_for_pixels(const volume::Rect& rect, Layout layout);

/// What came in such a room. Throws LinkLost when it is no such message.
volume::Image decode_pixels(PixelMessage& message, const volume::Rect& rect, volume::Operator op,
                            Layout layout);

}  // namespace understudy::compositor
