// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/model/transfer_function.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace viewer {

namespace {

// For the 8-bit CT of an engine block: casting near 0.5 to 0.6, denser inserts above 0.75. The dark lower end
// of the casting's ramp shades its edge, where voxels are half air.
constexpr ControlPoint engine[] = {
    {0.00, 0.20, 0.14, 0.10, 0.000}, {0.26, 0.20, 0.14, 0.10, 0.000}, {0.40, 0.42, 0.31, 0.22, 0.035},
    {0.52, 0.86, 0.70, 0.50, 0.080}, {0.60, 0.95, 0.86, 0.70, 0.060}, {0.66, 0.75, 0.35, 0.15, 0.050},
    {0.78, 0.98, 0.42, 0.10, 0.450}, {1.00, 1.00, 0.78, 0.30, 0.900},
};
// Soft tissue as a thin red veil, bone bright and dense.
constexpr ControlPoint bone[] = {
    {0.00, 0.60, 0.20, 0.12, 0.000}, {0.15, 0.60, 0.20, 0.12, 0.000}, {0.28, 0.72, 0.30, 0.20, 0.012},
    {0.42, 0.80, 0.50, 0.36, 0.010}, {0.52, 0.92, 0.84, 0.70, 0.100}, {0.75, 1.00, 0.97, 0.90, 0.500},
    {1.00, 1.00, 1.00, 1.00, 0.850},
};
// No voxel is empty: fog everywhere, denser with increasing value.
constexpr ControlPoint dense[] = {
    {0.00, 0.30, 0.40, 0.70, 0.008},
    {0.30, 0.45, 0.55, 0.75, 0.016},
    {0.60, 0.85, 0.80, 0.65, 0.040},
    {1.00, 1.00, 0.95, 0.85, 0.100},
};
// All but the highest values are empty.
constexpr ControlPoint sparse[] = {
    {0.00, 0.20, 0.60, 0.90, 0.000}, {0.70, 0.20, 0.60, 0.90, 0.000}, {0.76, 0.35, 0.75, 0.95, 0.200},
    {0.90, 0.85, 0.95, 1.00, 0.600}, {1.00, 1.00, 1.00, 1.00, 0.900},
};
// Opaque above a threshold: the hardest case for sampling.
constexpr ControlPoint step[] = {
    {0.00, 0.35, 0.60, 0.45, 0.00},
    {0.45, 0.35, 0.60, 0.45, 0.00},
    {0.45, 0.35, 0.60, 0.45, 1.00},
    {1.00, 0.95, 0.95, 0.60, 1.00},
};

constexpr Preset all_presets[] = {
    {"engine", "semi-transparent metal casting, bright dense inserts", engine},
    {"bone", "bright bone under a veil of soft tissue", bone},
    {"dense", "fog everywhere, without empty voxels", dense},
    {"sparse", "only the highest values", sparse},
    {"step", "opaque above a threshold", step},
};

ControlPoint sample(std::span<const ControlPoint> points, double value) {
  if (value <= points.front().value) return points.front();
  const auto upper = std::upper_bound(points.begin(), points.end(), value,
                                      [](double v, const ControlPoint& p) { return v < p.value; });
  if (upper == points.end()) return points.back();
  const ControlPoint& a = *(upper - 1);
  const ControlPoint& b = *upper;
  const double t = (value - a.value) / (b.value - a.value);
  return {value, std::lerp(a.red, b.red, t), std::lerp(a.green, b.green, t), std::lerp(a.blue, b.blue, t),
          std::lerp(a.opacity, b.opacity, t)};
}

std::uint8_t to_byte(double value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 1.0) * 255));
}

}  // namespace

std::span<const Preset> presets() {
  return all_presets;
}

const Preset* find_preset(std::string_view name_or_number) {
  std::size_t number = 0;
  const char* end = name_or_number.data() + name_or_number.size();
  if (std::from_chars(name_or_number.data(), end, number).ptr == end && number >= 1 &&
      number <= std::size(all_presets))
    return &all_presets[number - 1];
  for (const Preset& preset : all_presets)
    if (preset.name == name_or_number) return &preset;
  return nullptr;
}

Table make_table(const Preset& preset, double exponent, bool zero_is_empty) {
  Table table;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const ControlPoint p = sample(preset.points, static_cast<double>(i) / 255.0);
    // Not 1 - pow(1 - a, e), which loses small opacities.
    const double opacity = -std::expm1(exponent * std::log1p(-p.opacity));
    table[i] = {to_byte(p.red), to_byte(p.green), to_byte(p.blue), to_byte(opacity)};
  }
  if (zero_is_empty) table[0][3] = 0;
  return table;
}

Rgba8 look_up(const Table& table, double value) {
  const double position = std::clamp(value, 0.0, 1.0) * 255.0;
  const auto lower = static_cast<std::size_t>(position);
  const std::size_t upper = std::min<std::size_t>(lower + 1, 255);
  const double t = position - static_cast<double>(lower);
  Rgba8 colour;
  for (std::size_t channel = 0; channel < 4; ++channel)
    colour[channel] =
        static_cast<std::uint8_t>(std::lround(std::lerp(table[lower][channel], table[upper][channel], t)));
  return colour;
}

}  // namespace viewer
