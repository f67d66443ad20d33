// SPDX-License-Identifier: Apache-2.0
// `understudy compare A B`: the difference between two images.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "apps/understudy/images/image.h"

namespace understudy::launcher {

/// On a scale where 1 is full intensity, over red, green and blue, and over alpha if either image has alpha.
struct Difference {
  double max = 0;
  double rms = 0;
  /// 20 log10(1 / rms) in dB; infinite for equal images.
  double psnr() const;
};

/// Throws std::runtime_error that names both sizes if they differ, or the pixel if a value is not finite.
Difference difference(const RgbaImage& a, const RgbaImage& b);

/// Returns a map of the largest difference of each pixel's components as grey; white is the
/// largest difference of the image.
RgbaImage difference_map(const RgbaImage& a, const RgbaImage& b);

/// Returns the three lines that `compare` prints.
std::string difference_text(const Difference& difference);

void add_compare(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
