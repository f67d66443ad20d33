// SPDX-License-Identifier: Apache-2.0
// adversary_calibrate FOLDER
//
// Measures where the bound between right and wrong images lies. FOLDER holds what ADVERSARY_KEEP_IMAGES=1
// adversary_test has kept. Prints, for each bound, the percentage of images beyond it: of those shown under
// Understudy, and of bare images that were broken on purpose.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

#include "tests/adversary/tile_bound.h"

namespace adversary {
namespace {

namespace fs = std::filesystem;

constexpr int greatest_bound = 12;

/// A way to make a wrong image from the right one and the one before.
struct Break {
  const char* name;
  std::function<Image(const Image& now, const Image& before)> make;
  std::vector<int> scores = {};
};

template <typename Change>
Image with_pixels(Image image, Change change) {
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      change(&image.rgba[4 * (static_cast<std::size_t>(y) * image.width + x)], x, y);
  return image;
}

void scale(std::uint8_t* pixel, double by) {
  for (int i = 0; i < 3; ++i) pixel[i] = static_cast<std::uint8_t>(std::lround(std::min(255.0, by * pixel[i])));
}

/// Whether a pixel lies in one tile in the middle of the image.
bool in_tile(const Image& image, int x, int y) {
  return x / tile_edge == image.width / tile_edge / 2 && y / tile_edge == image.height / tile_edge / 2;
}

Image moved(const Image& image) {
  Image result = image;
  for (std::size_t i = 4; i < image.rgba.size(); ++i) result.rgba[i] = image.rgba[i - 4];
  return result;
}

std::vector<Break> breaks() {
  const auto scaled = [](double by) {
    return [by](const Image& now, const Image&) {
      return with_pixels(now, [by](std::uint8_t* pixel, int, int) { scale(pixel, by); });
    };
  };
  const auto scaled_tile = [](double by) {
    return [by](const Image& now, const Image&) {
      return with_pixels(now, [&, by](std::uint8_t* pixel, int x, int y) {
        if (in_tile(now, x, y)) scale(pixel, by);
      });
    };
  };
  return {
      {"the image of the frame before (1 degree)", [](const Image&, const Image& before) { return before; }},
      {"moved by one pixel", [](const Image& now, const Image&) { return moved(now); }},
      {"darker by 5 %", scaled(0.95)},
      {"darker by 10 %", scaled(0.9)},
      {"one tile darker by 10 %", scaled_tile(0.9)},
      {"one tile darker by 25 %", scaled_tile(0.75)},
      {"one tile of the frame before",
       [](const Image& now, const Image& before) {
         return with_pixels(now, [&](std::uint8_t* pixel, int x, int y) {
           const auto* from = &before.rgba[4 * (static_cast<std::size_t>(y) * before.width + x)];
           if (in_tile(now, x, y)) std::copy(from, from + 4, pixel);
         });
       }},
      {"red and blue exchanged", [](const Image& now, const Image&) {
         return with_pixels(now, [](std::uint8_t* pixel, int, int) { std::swap(pixel[0], pixel[2]); });
       }}};
}

std::vector<fs::path> frames_of(const fs::path& scenario) {
  std::vector<fs::path> names;
  for (const auto& entry : fs::directory_iterator(scenario / "under"))
    if (entry.path().extension() == ".pam") names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

void measure(const fs::path& scenario, std::vector<int>& shown, std::vector<int>& plain,
             std::vector<Break>& broken) {
  const auto names = frames_of(scenario);
  for (std::size_t i = 1; i < names.size(); ++i) {
    const Image bare = read_image(scenario / "bare" / names[i]),
                exact = read_image(scenario / "exact" / names[i]);
    const Image before = read_image(scenario / "bare" / names[i - 1]);
    shown.push_back(worst_tile(read_image(scenario / "under" / names[i]), bare, exact).excess);
    plain.push_back(worst_tile(exact, bare, bare).excess);
    if (before.width != bare.width || before.height != bare.height) continue;
    for (Break& each : broken) each.scores.push_back(worst_tile(each.make(bare, before), bare, exact).excess);
  }
}

double share_above(const std::vector<int>& scores, int bound) {
  const auto above = std::count_if(scores.begin(), scores.end(), [&](int score) { return score > bound; });
  return 100.0 * static_cast<double>(above) / static_cast<double>(std::max<std::size_t>(1, scores.size()));
}

void print_row(const char* name, const std::vector<int>& scores) {
  std::printf("%-42s", name);
  for (int bound = 0; bound <= greatest_bound; ++bound) std::printf(" %5.1f", share_above(scores, bound));
  std::printf("   of %zu\n", scores.size());
}

void calibrate(const fs::path& folder) {
  std::vector<int> shown, plain;
  std::vector<Break> broken = breaks();
  for (const auto& scenario : fs::directory_iterator(folder))
    if (fs::exists(scenario.path() / "under")) measure(scenario.path(), shown, plain, broken);
  std::printf("%-42s", "percent of images beyond a bound of");
  for (int bound = 0; bound <= greatest_bound; ++bound) std::printf(" %5d", bound);
  std::printf("\n");
  print_row("shown under Understudy", shown);
  print_row("exact, compared with the viewer's alone", plain);
  for (const Break& each : broken) print_row(each.name, each.scores);
}

}  // namespace
}  // namespace adversary

int main(int count, char** words) {
  try {
    if (count != 2) throw std::runtime_error("usage: adversary_calibrate FOLDER");
    adversary::calibrate(words[1]);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "adversary_calibrate: " << error.what() << "\n";
    return 1;
  }
}
