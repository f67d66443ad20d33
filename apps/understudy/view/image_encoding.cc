// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/view/image_encoding.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <span>
#include <stdexcept>

#include "apps/understudy/images/image.h"
#include "compositor/relay/jpeg.h"

namespace understudy::launcher {

RgbImage over_black(const volume::ImageView& image, const volume::Rect& window) {
  RgbImage rgb_image{window.width, window.height, {}};
  rgb_image.rgb.assign(3 * window.pixels(), 0);
  for (int y = 0; y < image.rect.height; ++y) {
    const float* from = &image.rgba[4 * std::size_t(y) * std::size_t(image.rect.width)];
    const int row = window.height - 1 - (image.rect.y + y - window.y);
    const int column = image.rect.x - window.x;
    std::uint8_t* to = &rgb_image.rgb[3 * (std::size_t(row) * std::size_t(window.width) + std::size_t(column))];
    for (int x = 0; x < image.rect.width; ++x, from += 4, to += 3)
      for (int channel = 0; channel < 3; ++channel) to[channel] = byte_of(from[channel]);
  }
  return rgb_image;
}

std::vector<std::byte> png_of(const RgbImage& rgb_image) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = png_uint_32(rgb_image.width);
  png.height = png_uint_32(rgb_image.height);
  png.format = PNG_FORMAT_RGB;
  png.flags = PNG_IMAGE_FLAG_FAST;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::vector<std::byte> bytes(size);
  if (png_image_write_to_memory(&png, bytes.data(), &size, 0, rgb_image.rgb.data(), 0, nullptr) == 0)
    throw std::runtime_error(fmt::format("an image of {} x {} pixels cannot be encoded as PNG: {}",
                                         rgb_image.width, rgb_image.height,
                                         static_cast<const char*>(png.message)));
  bytes.resize(size);
  return bytes;
}

std::vector<std::byte> jpeg_of(const RgbImage& rgb_image, int quality) {
  std::vector<std::byte> bytes;
  compositor::append_jpeg(std::as_bytes(std::span(rgb_image.rgb)), rgb_image.width, rgb_image.height,
                          compositor::JpegPixels::rgb, quality, bytes);
  return bytes;
}

}  // namespace understudy::launcher
