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

/// The pixels of `image` in `rect`, which lies inside it. Where that is shorter, only those that a sample has
/// reached (volume::neutral_value) travel, in runs.
PixelMessage encode_pixels(const volume::Image& image, const volume::Rect& rect, volume::Operator op,
                           Layout layout);

/// Room for the longest message about this rectangle.
PixelMessage room_for_pixels(const volume::Rect& rect, Layout layout);

/// What came in such a room. Throws LinkLost when it is no such message.
volume::Image decode_pixels(PixelMessage& message, const volume::Rect& rect, volume::Operator op,
                            Layout layout);

}  // namespace understudy::compositor
