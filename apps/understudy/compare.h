// `understudy compare A B`: how far two pictures are apart.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "apps/understudy/picture.h"

namespace understudy::launcher {

/// On the scale where 1 is full intensity, over red, green and blue, and over alpha where either picture has
/// some.
struct Difference {
  double max = 0;
  double rms = 0;
  /// 20 log10(1 / rms) in dB; infinite for equal pictures.
  double psnr() const;
};

/// Throws std::runtime_error naming both sizes when they differ, and the pixel when a value is not a number.
Difference difference(const Picture& a, const Picture& b);

/// The largest difference of a pixel's components as a shade of grey; white is the largest of the picture.
Picture difference_map(const Picture& a, const Picture& b);

/// The three lines that `compare` prints.
std::string difference_text(const Difference& difference);

void add_compare(CLI::App& app, std::function<int()>& chosen);

}  // namespace understudy::launcher
