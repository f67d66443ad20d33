// SPDX-License-Identifier: Apache-2.0
#include "volume/file/slices/jpeg_header.h"

namespace understudy::volume {

bool leads_to_a_jpeg_frame(std::span<const std::byte> image) {
  constexpr unsigned image_begins = 0xFFD8, huffman_tables = 0xFFC4, arithmetic_conditioning = 0xFFCC,
                     first_frame = 0xFFC0, last_frame = 0xFFCF, reserved_frame = 0xFFC8, quantization = 0xFFDB,
                     restart_interval = 0xFFDD, first_application = 0xFFE0, last_application = 0xFFEF,
                     comment = 0xFFFE;
  const auto word_at = [&](std::size_t at) {
    return std::to_integer<unsigned>(image[at]) << 8 | std::to_integer<unsigned>(image[at + 1]);
  };
  if (image.size() < 2 || word_at(0) != image_begins) return false;
  for (std::size_t at = 2; at + 4 <= image.size();) {
    const unsigned marker = word_at(at);
    const std::size_t length = word_at(at + 2);  // without the marker
    if (length < 2 || length > image.size() - at - 2) return false;
    const bool is_table = marker == huffman_tables || marker == arithmetic_conditioning ||
                          marker == quantization || marker == restart_interval || marker == comment ||
                          (marker >= first_application && marker <= last_application);
    if (!is_table) return marker >= first_frame && marker <= last_frame && marker != reserved_frame;
    at += 2 + length;
  }
  return false;
}

}  // namespace understudy::volume
