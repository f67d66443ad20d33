// SPDX-License-Identifier: Apache-2.0
// Encodes images for display: eight bits a channel over black, as PNG or JPEG.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "volume/image.h"

namespace understudy::launcher {

struct RgbImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  ///< rows top down, 3 * width * height
};

/// Rounds in the same way as write_png().
RgbImage over_black(const volume::ImageView& image, const volume::Rect& window);

/// Lossless, optimized for speed rather than size. Throws std::runtime_error.
std::vector<std::byte> png_of(const RgbImage& image);
/// Lossy, quality 1 to 100. Throws std::runtime_error.
std::vector<std::byte> jpeg_of(const RgbImage& image, int quality);

}  // namespace understudy::launcher
