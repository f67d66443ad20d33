// SPDX-License-Identifier: Apache-2.0
// Runs the viewer program as a user would, and reads its results.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace viewer_test {

struct Outcome {
  int status = -1;  ///< exit status; -1 if a signal ended it
  std::string out;
  std::string err;
};

/// Sets LIBGL_ALWAYS_SOFTWARE=1, and DISPLAY to `display` (unset if that is empty).
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
  double max = 0;   ///< of one channel, 0 to 255
  double rms = 0;   ///< over all channels, 0 to 255
  double psnr = 0;  ///< dB; infinite if equal
};

/// `a` and `b` are channel values from 0 to 255 of two images of the same size.
Difference difference(const std::vector<double>& a, const std::vector<double>& b);
Difference difference(const Image& a, const Image& b);

}  // namespace viewer_test
