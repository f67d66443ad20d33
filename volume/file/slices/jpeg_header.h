// SPDX-License-Identifier: Apache-2.0
// The first marker segments of a JPEG image (ITU T.81, annex B).
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace understudy::volume {

/// The contents of a frame header.
struct JpegFrame {
  unsigned bits = 0;  ///< per sample
  unsigned rows = 0;
  unsigned columns = 0;
  unsigned components = 0;
};

/// The header of the first frame. Empty unless it follows the image's start through valid marker segments
/// inside `image`: DCMTK 3.6.7 searches for it endlessly in damaged images.
std::optional<JpegFrame> first_jpeg_frame(std::span<const std::byte> image);

}  // namespace understudy::volume
