// SPDX-License-Identifier: Apache-2.0
// understudy-bench-blend: measures how fast one core blends pixels, in the caches and from memory, beside
// copying as many bytes. All methods alternate within each round. Times are processor times, so that other load
// on the machine matters little. Prints one JSON object a line.
#include "compositor/blend.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstring>
#include <ctime>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "compositor/exchange/pixel_layout.h"
#include "volume/blending_operator.h"
#include "volume/image.h"

namespace {

using namespace understudy;
using compositor::Layout;
using volume::Image;
using volume::Operator;

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

/// Values vary smoothly from pixel to pixel, as in real images; no pixel is clear.
Image smooth_image(int side, unsigned seed) {
  Image image({0, 0, side, side});
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0.95F, 1.05F);
  std::array<float, 4> pixel{0.3F, 0.2F, 0.1F, 0.4F};
  for (std::size_t i = 0; i < image.rgba.size(); i += 4)
    for (std::size_t c = 0; c < 4; ++c) {
      pixel[c] = std::clamp(pixel[c] * uniform(random), 0.05F, 0.5F);
      image.rgba[i + c] = pixel[c];
    }
  return image;
}

struct Way {
  std::string name;
  std::size_t bytes_per_pixel;  ///< sum of the bytes read and written
  std::function<void()> once;
  std::vector<double> seconds{};
};

compositor::PixelMessage arrived(const Image& image, Layout layout) {
  compositor::PixelMessage message = encode_pixels(image, image.rect, Operator::over, layout, true);
  message.received() = message.size();
  return message;
}

void measure(const char* place, int side, int rounds) {
  const Image back = smooth_image(side, 1);
  Image front = smooth_image(side, 2);
  const Image fresh = front;
  const std::span<float> target(front.rgba);
  std::vector<Way> ways;
  ways.push_back({"copy", 32, [&] { std::memcpy(target.data(), back.rgba.data(), target.size_bytes()); }});
  for (const auto& [name, op] : {std::pair("over", Operator::over), std::pair("max", Operator::max),
                                 std::pair("min", Operator::min), std::pair("add", Operator::add)})
    ways.push_back({name, 48, [&, op = op] { compositor::blend(op, target, back.rgba); }});
  std::vector<compositor::PixelMessage> messages;
  constexpr std::array layouts{std::pair("float message", Layout::rgba32f),
                               std::pair("half message", Layout::rgba16f),
                               std::pair("byte message", Layout::rgba8)};
  messages.reserve(layouts.size());
  for (const auto& [name, layout] : layouts) {
    const compositor::PixelMessage& message = messages.emplace_back(arrived(back, layout));
    const std::size_t packed = message.size() / std::max(std::size_t{1}, back.rect.pixels());
    ways.push_back({fmt::format("over, {}", name), 32 + packed, [&, layout = layout] {
                      compositor::PixelReader reader(message, back.rect, layout);
                      for (int y = 0; y < side; ++y)
                        reader.blend_row_behind(Operator::over, {front.at(0, y), 4 * std::size_t(side)});
                    }});
    ways.push_back({fmt::format("encode, {}", name), 16 + packed,
                    [&, layout = layout] { encode_pixels(back, back.rect, Operator::over, layout, true); }});
  }
  // The number of repetitions makes a turn take about as long in either place.
  const int times = std::max(1, (1 << 21) / (side * side));
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < ways.size(); ++i) {
      Way& way = ways[(i + std::size_t(round)) % ways.size()];
      front.rgba = fresh.rgba;
      way.once();
      const double start = processor_seconds();
      for (int k = 0; k < times; ++k) way.once();
      way.seconds.push_back((processor_seconds() - start) / times);
    }
  for (Way& way : ways) {
    std::ranges::sort(way.seconds);
    const double pixels = double(back.rect.pixels());
    fmt::print("{}\n",
               nlohmann::ordered_json{{"place", place},
                                      {"way", way.name},
                                      {"pixels_per_second", pixels / way.seconds[way.seconds.size() / 2]},
                                      {"bytes_per_pixel", way.bytes_per_pixel}}
                   .dump());
  }
}

}  // namespace

int main(int argc, char** argv) {
  int rounds = 31;
  CLI::App app{"Times blending on one core."};
  app.set_help_flag("-h,--help", "print this help and exit");
  app.add_option("--rounds", rounds, "number of rounds, of which the median counts")
      ->check(CLI::Range(1, 10000));
  CLI11_PARSE(app, argc, argv);
  try {
    measure("cache", 128, rounds);
    measure("memory", 2048, rounds);
  } catch (const std::exception& error) {
    fmt::print(stderr, "understudy-bench-blend: {}\n", error.what());
    return 1;
  }
}
