// SPDX-License-Identifier: Apache-2.0
#include "volume/file/slices/jpeg_header.h"

namespace understudy::volume {

std::optional<JpegFrame> first_jpeg_frame(std::span<const std::byte> image) {
  constexpr unsigned image_begins = 0xFFD8, huffman_tables = 0xFFC4, arithmetic_conditioning = 0xFFCC,
                     first_frame = 0xFFC0, last_frame = 0xFFCF, reserved_frame = 0xFFC8, quantization = 0xFFDB,
                     restart_interval = 0xFFDD, first_application = 0xFFE0, last_application = 0xFFEF,
                     comment = 0xFFFE, fill = 0xFFFF;
  const auto byte_at = [&](std::size_t at) { return std::to_integer<unsigned>(image[at]); };
  const auto word_at = [&](std::size_t at) { return byte_at(at) << 8 | byte_at(at + 1); };
  if (image.size() < 2 || word_at(0) != image_begins) return std::nullopt;
  for (std::size_t at = 2; at + 4 <= image.size();) {
    const unsigned marker = word_at(at);
    if (marker == fill) {
      ++at;
      continue;
    }
    const std::size_t length = word_at(at + 2);  // without the marker
    if (length < 2 || length > image.size() - at - 2) return std::nullopt;
    const bool is_table = marker == huffman_tables || marker == arithmetic_conditioning ||
                          marker == quantization || marker == restart_interval || marker == comment ||
                          (marker >= first_application && marker <= last_application);
    if (is_table) {
      at += 2 + length;
      continue;
    }
    constexpr std::size_t frame_header = 8;
    const bool is_frame = marker >= first_frame && marker <= last_frame && marker != reserved_frame;
    if (!is_frame || length < frame_header) return std::nullopt;
    return JpegFrame{byte_at(at + 4), word_at(at + 5), word_at(at + 7), byte_at(at + 9)};
  }
  return std::nullopt;
}

}  // namespace understudy::volume
