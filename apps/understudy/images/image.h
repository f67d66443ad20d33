// SPDX-License-Identifier: Apache-2.0
// Image files: PNG, and PFM (Debevec's portable float map) for composited frames before rounding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "volume/image.h"

namespace understudy::launcher {

constexpr int max_image_side = 16384;
constexpr int max_image_pixels = 64 << 20;  ///< 1 GiB as float RGBA

/// RGBA, rows top down, 1 is full intensity. PNG colours are taken as stored (no gamma), PFM values as saved.
struct RgbaImage {
  int width = 0;
  int height = 0;
  bool has_alpha = false;   ///< false: alpha is 1 everywhere
  std::vector<float> rgba;  ///< 4 * width * height

  float* pixel(int x, int y) { return &rgba[4 * (static_cast<std::size_t>(y) * width + x)]; }
  const float* pixel(int x, int y) const { return &rgba[4 * (static_cast<std::size_t>(y) * width + x)]; }
};

/// Returns a premultiplied rendered image, enlarged to its window; pixels outside the image are transparent.
RgbaImage whole_window(const volume::ImageView& image, const volume::Rect& window);

/// Converts 0 to 1 to a byte, rounded to nearest; values outside are clamped, and NaN becomes 0.
constexpr std::uint8_t byte_of(float value) {
  const float scaled = 255.0F * (value > 0 ? value < 1 ? value : 1.0F : 0.0F);
  const int whole = int(scaled);
  return std::uint8_t(scaled - float(whole) >= 0.5F ? whole + 1 : whole);
}

/// Reads a PNG or a PFM image, detected by its first bytes. The alpha channel of `frame.pfm` is read from
/// `frame_alpha.pfm` beside it, if that exists. Throws std::runtime_error with the path and what is wrong.
RgbaImage read_image(const std::filesystem::path& path);

/// Returns the image as a PNG file; values outside 0 to 1 are clamped. Throws std::runtime_error.
std::vector<std::byte> png_bytes(const RgbaImage& image);

/// Writes a PNG image; values outside 0 to 1 are clamped. Throws std::runtime_error.
void write_png(const std::filesystem::path& path, const RgbaImage& image);

/// Writes the colours unchanged, and alpha, if there is any, to a file beside it, named as read_image()
/// expects. Throws std::runtime_error.
void write_pfm(const std::filesystem::path& path, const RgbaImage& image);

}  // namespace understudy::launcher
