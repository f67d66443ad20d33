// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/images/image.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace understudy::launcher {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
  throw std::runtime_error(fmt::format("{}: {}", path.string(), what));
}

void check_size(const std::filesystem::path& path, std::int64_t width, std::int64_t height) {
  if (width >= 1 && height >= 1 && width <= max_image_side && height <= max_image_side &&
      width * height <= max_image_pixels) {
    return;
  }
  fail(path, fmt::format("{} x {} pixels; each side must be 1 to {} pixels, and the image at most {} pixels",
                         width, height, max_image_side, max_image_pixels));
}

RgbaImage empty_image(const std::filesystem::path& path, std::int64_t width, std::int64_t height) {
  check_size(path, width, height);
  RgbaImage image;
  image.width = static_cast<int>(width);
  image.height = static_cast<int>(height);
  image.rgba.assign(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 1.0F);
  return image;
}

/// libpng's description of one image, freed in every case.
struct PngImage {
  png_image image{};
  PngImage() { image.version = PNG_IMAGE_VERSION; }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
  ~PngImage() { png_image_free(&image); }
};

/// An image as libpng writes it.
struct BytesOfPng {
  PngImage description;
  std::vector<std::uint8_t> pixels;

  explicit BytesOfPng(const RgbaImage& image) : pixels(image.rgba.size()) {
    description.image.width = static_cast<png_uint_32>(image.width);
    description.image.height = static_cast<png_uint_32>(image.height);
    description.image.format = PNG_FORMAT_RGBA;
    std::transform(image.rgba.begin(), image.rgba.end(), pixels.begin(), byte_of);
  }
};

RgbaImage read_png(const std::filesystem::path& path) {
  PngImage png;
  if (png_image_begin_read_from_file(&png.image, path.c_str()) == 0) fail(path, png.image.message);
  RgbaImage image = empty_image(path, png.image.width, png.image.height);
  image.has_alpha = (png.image.format & PNG_FORMAT_FLAG_ALPHA) != 0;
  png.image.format = PNG_FORMAT_RGBA;
  std::vector<std::uint8_t> bytes(image.rgba.size());
  if (png_image_finish_read(&png.image, nullptr, bytes.data(), 0, nullptr) == 0) fail(path, png.image.message);
  std::transform(bytes.begin(), bytes.end(), image.rgba.begin(),
                 [](std::uint8_t value) { return static_cast<float>(value) / 255.0F; });
  return image;
}

/// The content of a PFM file: `PF` with three channels or `Pf` with one, rows bottom up, a
/// negative scale for little endian.
struct FloatMap {
  int channels = 0;
  int width = 0;
  int height = 0;
  std::vector<float> values;
};

FloatMap read_float_map(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) fail(path, std::strerror(errno));
  std::string kind;
  std::int64_t width = 0;
  std::int64_t height = 0;
  double scale = 0;
  file >> kind >> width >> height >> scale;
  if (!file || (kind != "PF" && kind != "Pf") || scale == 0 || file.get() != '\n')
    fail(path, "not a valid PFM image");
  FloatMap map;
  map.channels = kind == "PF" ? 3 : 1;
  check_size(path, width, height);
  map.width = static_cast<int>(width);
  map.height = static_cast<int>(height);
  const std::int64_t count = width * height * map.channels;
  const auto bytes = static_cast<std::streamsize>(count * static_cast<std::int64_t>(sizeof(float)));
  const std::streamoff start = file.tellg();
  const std::streamoff held = file.seekg(0, std::ios::end).tellg() - std::streampos(start);
  if (held < bytes) fail(path, fmt::format("the file ends after {} of {} bytes of pixels", held, bytes));
  file.seekg(start);
  map.values.resize(static_cast<std::size_t>(count));
  file.read(reinterpret_cast<char*>(map.values.data()), bytes);
  if (!file) fail(path, std::strerror(errno));
  const bool little = scale < 0;
  if (little != (std::endian::native == std::endian::little)) {
    for (float& value : map.values)
      value = std::bit_cast<float>(__builtin_bswap32(std::bit_cast<std::uint32_t>(value)));
  }
  return map;
}

RgbaImage read_pfm(const std::filesystem::path& path) {
  const FloatMap colour = read_float_map(path);
  RgbaImage image = empty_image(path, colour.width, colour.height);
  const auto value_of = [&](const FloatMap& map, int x, int y, int channel) {
    const std::size_t row = static_cast<std::size_t>(map.height) - 1 - static_cast<std::size_t>(y);
    return map.values[(row * map.width + x) * map.channels + std::min(channel, map.channels - 1)];
  };
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int channel = 0; channel < 3; ++channel)
        image.pixel(x, y)[channel] = value_of(colour, x, y, channel);
    }
  }
  std::filesystem::path beside = path;
  beside.replace_filename(path.stem().string() + "_alpha.pfm");
  if (!std::filesystem::exists(beside)) return image;
  const FloatMap alpha = read_float_map(beside);
  if (alpha.width != colour.width || alpha.height != colour.height)
    fail(beside, "the alpha image differs in size from the colour image");
  image.has_alpha = true;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) image.pixel(x, y)[3] = value_of(alpha, x, y, 0);
  }
  return image;
}

void write_float_map(const std::filesystem::path& path, const RgbaImage& image, int first, int channels) {
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(image.width) * image.height * channels);
  for (int y = image.height - 1; y >= 0; --y) {
    for (int x = 0; x < image.width; ++x) {
      const float* const pixel = image.pixel(x, y) + first;
      values.insert(values.end(), pixel, pixel + channels);
    }
  }
  std::ofstream file(path, std::ios::binary);
  file << (channels == 3 ? "PF" : "Pf") << '\n'
       << image.width << ' ' << image.height << '\n'
       << (std::endian::native == std::endian::little ? "-1.0\n" : "1.0\n");
  file.write(reinterpret_cast<const char*>(values.data()),
             static_cast<std::streamsize>(values.size() * sizeof(float)));
  file.close();
  if (!file) fail(path, "cannot be written; check that the folder exists and the disk is not full");
}

}  // namespace

RgbaImage whole_window(const volume::ImageView& image, const volume::Rect& window) {
  RgbaImage whole{window.width, window.height, true, std::vector<float>(4 * window.pixels())};
  const auto row = 4 * std::size_t(image.rect.width);
  for (int y = 0; y < image.rect.height; ++y)
    std::copy_n(image.rgba.data() + std::size_t(y) * row, row,
                whole.pixel(image.rect.x - window.x, window.height - 1 - (image.rect.y - window.y + y)));
  return whole;
}

RgbaImage read_image(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) fail(path, std::strerror(errno));
  std::array<char, 8> start{};
  file.read(start.data(), start.size());
  if (file.gcount() == 8 && png_sig_cmp(reinterpret_cast<png_bytep>(start.data()), 0, 8) == 0)
    return read_png(path);
  if (file.gcount() >= 3 && start[0] == 'P' && (start[1] == 'F' || start[1] == 'f')) return read_pfm(path);
  fail(path, "neither a PNG nor a PFM image");
}

std::vector<std::byte> png_bytes(const RgbaImage& image) {
  BytesOfPng png(image);
  png_alloc_size_t size = 0;
  std::vector<std::byte> file;
  // The first call only determines the size.
  for (const bool measured : {false, true}) {
    if (measured) file.resize(size);
    if (png_image_write_to_memory(&png.description.image, measured ? file.data() : nullptr, &size, 0,
                                  png.pixels.data(), 0, nullptr) == 0)
      throw std::runtime_error(png.description.image.message);
  }
  file.resize(size);
  return file;
}

void write_png(const std::filesystem::path& path, const RgbaImage& image) {
  BytesOfPng png(image);
  if (png_image_write_to_file(&png.description.image, path.c_str(), 0, png.pixels.data(), 0, nullptr) == 0)
    fail(path, png.description.image.message);
}

void write_pfm(const std::filesystem::path& path, const RgbaImage& image) {
  write_float_map(path, image, 0, 3);
  if (!image.has_alpha) return;
  std::filesystem::path beside = path;
  beside.replace_filename(path.stem().string() + "_alpha.pfm");
  write_float_map(beside, image, 3, 1);
}

}  // namespace understudy::launcher
