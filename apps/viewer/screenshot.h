// SPDX-License-Identifier: Apache-2.0
// Images out of the framebuffer and into PNG files.
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

/// The current context's read buffer (the back buffer of a window).
Image read_back(int width, int height);

/// Throws Error (bad_file) when the file cannot be written.
void write_png(const Image& image, const std::string& path);

}  // namespace viewer
