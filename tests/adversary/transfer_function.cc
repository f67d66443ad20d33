// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/transfer_function.h"

#include <algorithm>
#include <cmath>

namespace adversary {
namespace {

constexpr int entries = 256;

std::uint8_t byte(double value) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
}

double wave(double at, double turns, double phase) {
  return 0.5 + 0.5 * std::sin(6.2832 * (turns * at + phase));
}

template <typename ColourAt>
std::vector<Colour> table(ColourAt colour_at) {
  std::vector<Colour> colours;
  for (int i = 0; i < entries; ++i) colours.push_back(colour_at(i / (entries - 1.0)));
  return colours;
}

}  // namespace

std::vector<Colour> soft_colours() {
  return table([](double at) {
    return Colour{byte(wave(at, 1.3, 0)), byte(wave(at, 1.7, 0.3)), byte(wave(at, 1.1, 0.7)),
                  byte(0.02 + 0.1 * wave(at, 2, 0.6) * at)};
  });
}

std::vector<Colour> other_colours() {
  return table([](double at) {
    return Colour{byte(wave(at, 1.6, 0.6)), byte(wave(at, 0.9, 0.1)), byte(wave(at, 1.4, 0.2)),
                  byte(0.02 + 0.1 * wave(at, 1.5, 0.1) * (1 - at))};
  });
}

std::vector<Colour> opaque_colours() {
  return table([](double at) { return Colour{byte(at), byte(0.2 + 0.6 * at * at), byte(1 - at), 255}; });
}

std::vector<Colour> step_colours() {
  constexpr std::array<Colour, 4> colours{
      Colour{40, 60, 200, 4}, {30, 200, 90, 14}, {230, 200, 40, 6}, {220, 40, 50, 24}};
  return table([&](double at) { return colours[static_cast<std::size_t>(std::min(3.0, at * 4))]; });
}

std::vector<Colour> premultiplied(std::vector<Colour> colours) {
  for (Colour& colour : colours)
    for (int i = 0; i < 3; ++i) colour[i] = byte(colour[i] / 255.0 * colour[3] / 255.0);
  return colours;
}

std::vector<float> as_floats(const std::vector<Colour>& colours) {
  std::vector<float> floats;
  for (const Colour& colour : colours)
    for (const std::uint8_t channel : colour) floats.push_back(static_cast<float>(channel) / 255);
  return floats;
}

}  // namespace adversary
