// SPDX-License-Identifier: Apache-2.0
// Images in files: PNG, and PFM (Debevec's portable float map) for composited frames before they are rounded.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "volume/image.h"

namespace understudy::launcher {

constexpr int max_image_side = 16384;
constexpr int max_image_pixels = 64 << 20;  ///< 1 GiB as float RGBA

/// RGBA, rows top down, 1 is full intensity. PNG colours as they stand in the file (no gamma), PFM as saved.
struct RgbaImage {
  int width = 0;
  int height = 0;
  bool has_alpha = false;   ///< false: alpha is 1 everywhere
  std::vector<float> rgba;  ///< 4 * width * height

  float* pixel(int x, int y) { return &rgba[4 * (static_cast<std::size_t>(y) * width + x)]; }
  const float* pixel(int x, int y) const { return &rgba[4 * (static_cast<std::size_t>(y) * width + x)]; }
};

/// A rendered image, premultiplied, in all of its window: transparent where it has no pixels.
RgbaImage whole_window(const volume::ImageView& image, const volume::Rect& window);

/// 0 to 1 as a byte, rounded to nearest; values outside are clamped, and what is no number is 0.
constexpr std::uint8_t byte_of(float value) {
  const float scaled = 255.0F * (value > 0 ? value < 1 ? value : 1.0F : 0.0F);
  const int whole = int(scaled);
  return std::uint8_t(scaled - float(whole) >= 0.5F ? whole + 1 : whole);
}

/// Reads a PNG or a PFM by its first bytes. Beside `frame.pfm`, `frame_alpha.pfm` is its alpha when it exists.
/// Throws std::runtime_error with the path and what is wrong.
RgbaImage read_image(const std::filesystem::path& path);

/// Values outside 0 to 1 are clamped. Throws std::runtime_error.
void write_png(const std::filesystem::path& path, const RgbaImage& image);

/// Colours as they are, and beside them their alpha when there is one, named as read_image() expects it.
/// Throws std::runtime_error.
void write_pfm(const std::filesystem::path& path, const RgbaImage& image);

}  // namespace understudy::launcher
