// SPDX-License-Identifier: Apache-2.0
// `understudy compare A B`: how far two images are apart.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "apps/understudy/images/image.h"

namespace understudy::launcher {

/// On the scale where 1 is full intensity, over red, green and blue, and over alpha where either image has
/// some.
struct Difference {
  double max = 0;
  double rms = 0;
  /// 20 log10(1 / rms) in dB; infinite for equal images.
  double psnr() const;
};

/// Throws std::runtime_error naming both sizes when they differ, and the pixel when a value is not a number.
Difference difference(const RgbaImage& a, const RgbaImage& b);

/// The largest difference of a pixel's components as a shade of grey; white is the largest of the image.
RgbaImage difference_map(const RgbaImage& a, const RgbaImage& b);

/// The three lines that `compare` prints.
std::string difference_text(const Difference& difference);

void add_compare(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
