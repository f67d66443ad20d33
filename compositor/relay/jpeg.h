// SPDX-License-Identifier: Apache-2.0
// Images as JPEG (libjpeg-turbo), for views that move over slow lines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace understudy::compositor {

enum class JpegPixels : std::uint8_t { bgrx, rgbx, rgb, gray };

constexpr int max_jpeg_extent = 65500;

/// `pixels`: rows tightly packed, a byte for each letter of the format, one for gray. `quality` 1 to 100; below
/// 90 colours have half the resolution. Appends to `to`.
void append_jpeg(std::span<const std::byte> pixels, int width, int height, JpegPixels format, int quality,
                 std::vector<std::byte>& to);
/// A fourth byte of a pixel is 255. Throws MalformedMessage where `jpeg` is no image of that size.
void read_jpeg(std::span<const std::byte> jpeg, int width, int height, JpegPixels format,
               std::span<std::byte> to);

}  // namespace understudy::compositor
