// SPDX-License-Identifier: Apache-2.0
#include "apps/understudy/cli/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <stdexcept>

#include "apps/understudy/cli/output_file.h"

namespace understudy::launcher {
namespace {

int compared_channels(const RgbaImage& a, const RgbaImage& b) {
  return a.has_alpha || b.has_alpha ? 4 : 3;
}

void check_sizes(const RgbaImage& a, const RgbaImage& b) {
  if (a.width == b.width && a.height == b.height) return;
  throw std::runtime_error(fmt::format("the images have different sizes: {} x {} and {} x {} pixels", a.width,
                                       a.height, b.width, b.height));
}

}  // namespace

double Difference::psnr() const {
  return rms > 0 ? -20 * std::log10(rms) : std::numeric_limits<double>::infinity();
}

Difference difference(const RgbaImage& a, const RgbaImage& b) {
  check_sizes(a, b);
  const int channels = compared_channels(a, b);
  Difference result;
  double sum = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      for (int channel = 0; channel < channels; ++channel) {
        const double apart = std::abs(double{a.pixel(x, y)[channel]} - b.pixel(x, y)[channel]);
        if (!std::isfinite(apart)) {
          throw std::runtime_error(fmt::format("pixel {}, {} has a value that is not a finite number", x, y));
        }
        result.max = std::max(result.max, apart);
        sum += apart * apart;
      }
    }
  }
  result.rms = std::sqrt(sum / (static_cast<double>(a.width) * a.height * channels));
  return result;
}

RgbaImage difference_map(const RgbaImage& a, const RgbaImage& b) {
  const auto white = static_cast<float>(difference(a, b).max);
  const int channels = compared_channels(a, b);
  RgbaImage map = a;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      float apart = 0;
      for (int channel = 0; channel < channels; ++channel) {
        apart = std::max(apart, std::abs(a.pixel(x, y)[channel] - b.pixel(x, y)[channel]));
      }
      std::fill_n(map.pixel(x, y), 3, white > 0 ? apart / white : 0.0F);
      map.pixel(x, y)[3] = 1.0F;
    }
  }
  return map;
}

std::string difference_text(const Difference& difference) {
  const std::string psnr = std::isinf(difference.psnr()) ? "inf" : fmt::format("{:.2f}", difference.psnr());
  // Errors of float images are far below the fourth decimal, so they are printed with an exponent.
  const auto number = [](double value) {
    return value == 0 || value >= 1e-3 ? fmt::format("{:.4f}", value) : fmt::format("{:.2e}", value);
  };
  return fmt::format("max {}\nRMS {}\nPSNR {} dB\n", number(difference.max), number(difference.rms), psnr);
}

void add_compare(CLI::App& app, std::function<int()>& chosen) {
  struct Arguments {
    std::string a;
    std::string b;
    std::string map;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* compare = app.add_subcommand("compare", "prints the difference between two images (PNG or PFM)");
  compare
      ->add_option("A", arguments->a,
                   "first image; the alpha channel of frame.pfm is read from frame_alpha.pfm beside it")
      ->required();
  compare->add_option("B", arguments->b, "second image, of the same size")->required();
  compare
      ->add_option("--map", arguments->map,
                   "write the difference as a PNG image, in which white is the largest difference")
      ->check(can_be_written(".png"));
  compare->callback([arguments, &chosen] {
    chosen = [arguments] {
      const RgbaImage a = read_image(arguments->a);
      const RgbaImage b = read_image(arguments->b);
      std::fputs(difference_text(difference(a, b)).c_str(), stdout);
      if (!arguments->map.empty()) write_png(arguments->map, difference_map(a, b));
      return 0;
    };
  });
}

}  // namespace understudy::launcher
