// SPDX-License-Identifier: Apache-2.0
// Images as JPEG (libjpeg-turbo), for moving views over slow connections.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace understudy::compositor {

enum class JpegPixels : std::uint8_t { bgrx, rgbx, rgb, gray };

constexpr int max_jpeg_extent = 65500;

/// Appends a JPEG image of `pixels` to `to`. The rows of `pixels` are tightly packed, a byte for each letter of
/// the format, one for gray. `quality` is 1 to 100; below 90, colours have half the resolution.
void append_jpeg(std::span<const std::byte> pixels, int width, int height, JpegPixels format, int quality,
                 std::vector<std::byte>& to);
/// A fourth byte of a pixel becomes 255. Throws MalformedMessage if `jpeg` is no image of that size.
void read_jpeg(std::span<const std::byte> jpeg, int width, int height, JpegPixels format,
               std::span<std::byte> to);

}  // namespace understudy::compositor
