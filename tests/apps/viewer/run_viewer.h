// SPDX-License-Identifier: Apache-2.0
// Runs the viewer program as a user would, and looks at what it leaves.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace viewer_test {

struct Outcome {
  int status = -1;  ///< exit status; -1 when it ended by a signal
  std::string out;
  std::string err;
};

/// With LIBGL_ALWAYS_SOFTWARE=1, and `display` as DISPLAY (none when it is empty).
Outcome run_viewer(const std::vector<std::string>& arguments, const std::string& display = "");

/// The same for any program found on PATH.
Outcome run_program(const std::vector<std::string>& command, const std::string& display = "");

struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  ///< top row first
};

Image read_png(const std::string& path);

struct Difference {
  double max = 0;   ///< of a channel, 0 to 255
  double rms = 0;   ///< over all channels, 0 to 255
  double psnr = 0;  ///< dB; infinite when equal
};

/// `a` and `b` are channel values from 0 to 255 of images of one size.
Difference difference(const std::vector<double>& a, const std::vector<double>& b);
Difference difference(const Image& a, const Image& b);

}  // namespace viewer_test
