// SPDX-License-Identifier: Apache-2.0
// Reads images from the framebuffer and writes them to PNG files.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace viewer {

struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  ///< top row first
};

/// Reads the current context's read buffer (the back buffer of a window).
Image read_back(int width, int height);

/// Throws Error (bad_file) if the file cannot be written.
void write_png(const Image& image, const std::string& path);

}  // namespace viewer
