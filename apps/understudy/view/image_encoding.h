// SPDX-License-Identifier: Apache-2.0
// Images as bytes on their way to an eye: eight bits a channel over black, as PNG or JPEG.
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

/// Rounded as write_png() rounds.
RgbImage over_black(const volume::ImageView& image, const volume::Rect& window);

/// Without loss, packed fast rather than small. Throws std::runtime_error.
std::vector<std::byte> png_of(const RgbImage& image);
/// With loss, quality 1 to 100. Throws std::runtime_error.
std::vector<std::byte> jpeg_of(const RgbImage& image, int quality);

}  // namespace understudy::launcher
