// SPDX-License-Identifier: Apache-2.0
// The markers that a JPEG image begins with (ITU T.81, annex B).
#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace understudy::volume {

/// What a frame header says.
struct JpegFrame {
  unsigned bits = 0;  ///< of a sample
  unsigned rows = 0;
  unsigned columns = 0;
  unsigned components = 0;
};

/// That of the first frame. None unless marker segments lead to it from the image's begin, each within `image`:
/// DCMTK 3.6.7 looks for it in damaged images without end.
std::optional<JpegFrame> first_jpeg_frame(std::span<const std::byte> image);

}  // namespace understudy::volume
