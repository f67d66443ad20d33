// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/screenshot.h"

#include <GL/glew.h>
#include <fmt/format.h>
#include <png.h>

#include <algorithm>

#include "apps/viewer/model/error.h"

namespace viewer {

Image read_back(int width, int height) {
  const std::size_t row = static_cast<std::size_t>(width) * 3;
  Image image{width, height, std::vector<std::uint8_t>(row * static_cast<std::size_t>(height))};
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, image.rgb.data());
  for (std::size_t low = 0, high = static_cast<std::size_t>(height); low + 1 < high; ++low) {
    --high;
    const auto begin = image.rgb.begin();
    std::swap_ranges(begin + static_cast<std::ptrdiff_t>(low * row),
                     begin + static_cast<std::ptrdiff_t>((low + 1) * row),
                     begin + static_cast<std::ptrdiff_t>(high * row));
  }
  return image;
}

void write_png(const Image& image, const std::string& path) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  if (!png_image_write_to_file(&png, path.c_str(), 0, image.rgb.data(), 0, nullptr))
    throw Error(
        ExitCode::bad_file,
        fmt::format(
            "{}: the image cannot be written: {}; check that the folder exists and the disk is not full", path,
            png.message));
}

}  // namespace viewer
