// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/images/read_image.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

namespace understudy::launcher {
namespace {

constexpr int smallest_image_side = 16;

/// Positions of red, green, blue and alpha in a pixel; -1 for a missing component.
struct Components {
  int count = 0;
  std::array<int, 4> at{-1, -1, -1, -1};
};

std::optional<Components> components_of(GLenum format) {
  switch (format) {
    case GL_RGB:
      return Components{3, {0, 1, 2, -1}};
    case GL_RGBA:
      return Components{4, {0, 1, 2, 3}};
    case GL_BGR:
      return Components{3, {2, 1, 0, -1}};
    case GL_BGRA:
      return Components{4, {2, 1, 0, 3}};
    case GL_RED:
    case GL_LUMINANCE:
      return Components{1, {0, 0, 0, -1}};
    default:
      return std::nullopt;
  }
}

/// Returns component `at` of the pixel at `pixel`; 1 is full intensity.
float component(const std::byte* pixel, GLenum type, int count, int at) {
  switch (type) {
    case GL_UNSIGNED_BYTE:
    case GL_UNSIGNED_INT_8_8_8_8_REV:
      return float(std::to_integer<int>(pixel[at])) / 255.0F;
    case GL_UNSIGNED_INT_8_8_8_8:
      return float(std::to_integer<int>(pixel[count - 1 - at])) / 255.0F;
    case GL_UNSIGNED_SHORT: {
      std::uint16_t value = 0;
      std::memcpy(&value, pixel + std::ptrdiff_t(2) * at, sizeof value);
      return float(value) / 65535.0F;
    }
    default: {
      float value = 0;
      std::memcpy(&value, pixel + std::ptrdiff_t(4) * at, sizeof value);
      return value;
    }
  }
}

bool is_known(GLenum type, int components) {
  const bool packed = type == GL_UNSIGNED_INT_8_8_8_8 || type == GL_UNSIGNED_INT_8_8_8_8_REV;
  return type == GL_UNSIGNED_BYTE || type == GL_UNSIGNED_SHORT || type == GL_FLOAT ||
         (packed && components == 4);
}

RgbaImage empty_image(int width, int height) {
  RgbaImage image;
  image.width = width;
  image.height = height;
  image.rgba.assign(std::size_t(4) * std::size_t(width) * std::size_t(height), 1.0F);
  return image;
}

}  // namespace

RgbaImage image_of(std::span<const std::uint8_t> rgba, spu::Extent2D extent) {
  RgbaImage image = empty_image(extent.width, extent.height);
  for (int y = 0; y < image.height; ++y) {
    const std::uint8_t* row =
        &rgba[std::size_t(4) * std::size_t(image.height - 1 - y) * std::size_t(image.width)];
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < 3; ++c) image.pixel(x, y)[c] = float(row[4 * x + c]) / 255.0F;
    }
  }
  return image;
}

std::optional<RgbaImage> image_of(const spu::Decoder::ReadImage& read) {
  const auto components = components_of(read.shape.format);
  const auto pixel_bytes = spu::pixel_bytes(read.shape.format, read.shape.type);
  const int width = read.shape.width;
  const int height = read.shape.height;
  if (!components || !pixel_bytes || !is_known(read.shape.type, components->count) ||
      std::min(width, height) < smallest_image_side || std::max(width, height) > max_image_side ||
      read.pixels.size() < *pixel_bytes * std::size_t(width) * std::size_t(height)) {
    return std::nullopt;
  }
  RgbaImage image = empty_image(width, height);
  image.has_alpha = components->at[3] >= 0;
  for (int y = 0; y < height; ++y) {
    const std::byte* row = &read.pixels[*pixel_bytes * std::size_t(width) * std::size_t(height - 1 - y)];
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 4; ++c) {
        if (components->at[std::size_t(c)] < 0) continue;
        image.pixel(x, y)[c] = component(row + *pixel_bytes * std::size_t(x), read.shape.type,
                                         components->count, components->at[std::size_t(c)]);
      }
    }
  }
  return image;
}

}  // namespace understudy::launcher
