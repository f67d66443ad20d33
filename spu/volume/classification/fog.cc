// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/classification/fog.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace understudy::spu {
namespace {

/// Half a step of an 8-bit framebuffer: above the error of interpolating over the scalar, and invisible.
constexpr float same_as_fog = 2e-3F;
/// This many entries are compared to separate the fog from the colours under it.
constexpr std::size_t most_samples = 8;
/// Values of the scalar for each entry.
constexpr std::size_t values_per_entry = 3;

/// The application's framebuffer clamps fragments before it blends them.
volume::Rgba clamped(volume::Rgba colour) {
  for (float& component : colour) component = std::clamp(component, 0.0F, 1.0F);
  return colour;
}

/// Visible entries, spread evenly.
std::vector<std::size_t> telling_entries(const std::vector<volume::Rgba>& table) {
  std::vector<std::size_t> visible;
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (table[i][3] > 0) visible.push_back(i);
  }
  std::vector<std::size_t> chosen;
  const std::size_t count = std::min(most_samples, visible.size());
  for (std::size_t k = 0; k < count; ++k)
    chosen.push_back(visible[count > 1 ? k * (visible.size() - 1) / (count - 1) : 0]);
  return chosen;
}

/// Sums of products of one component over all samples; r is the factor of the added colour.
struct Sums {
  double xx = 0, xy = 0, rx = 0, ry = 0, rr = 0;
};

using Samples = std::vector<std::vector<volume::Rgba>>;  ///< by entry, then by value of the scalar

/// Returns the index of the needed value at which the fog is thinnest: where colours differ most.
std::size_t clearest_number(const Samples& seen, const std::vector<float>& number,
                            const std::array<float, 2>& needed) {
  std::size_t clearest = 0;
  double most_contrast = -1;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < needed[0] || number[v] > needed[1]) continue;
    double contrast = 0;
    for (const auto& sample : seen) {
      for (std::size_t c = 0; c < 3; ++c) contrast += std::abs(double(sample[v][c]) - seen.front()[v][c]);
    }
    if (contrast > most_contrast + 1e-6) {
      most_contrast = contrast;
      clearest = v;
    }
  }
  return clearest;
}

/// Returns the fog at value `v`, relative to the colours where it is thinnest; null if no fog explains all
/// samples.
std::optional<volume::Rgba> fog_at(const Samples& seen, bool premultiplied, std::size_t clearest,
                                   std::size_t v) {
  // Least squares for y = weight x + r added over samples and components; r is 1 or, if premultiplied, opacity.
  std::array<Sums, 3> sums{};
  double above = 0;
  double below = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    Sums& sum = sums[c];
    for (const auto& sample : seen) {
      const double x = sample[clearest][c];
      const double y = sample[v][c];
      const double r = premultiplied ? double(sample[v][3]) : 1.0;
      sum.xx += x * x;
      sum.xy += x * y;
      sum.rx += r * x;
      sum.ry += r * y;
      sum.rr += r * r;
    }
    above += sum.xy - sum.rx * sum.ry / sum.rr;
    below += sum.xx - sum.rx * sum.rx / sum.rr;
  }
  // Samples of one colour do not separate weight and added colour, and need not.
  const double weight = below > 1e-6 ? above / below : 1.0;
  volume::Rgba entry{0, 0, 0, float(weight)};
  for (std::size_t c = 0; c < 3; ++c) entry[c] = float((sums[c].ry - weight * sums[c].rx) / sums[c].rr);
  for (const auto& sample : seen) {
    for (std::size_t c = 0; c < 3; ++c) {
      const float r = premultiplied ? sample[v][3] : 1.0F;
      const float expected = entry[3] * sample[clearest][c] + r * entry[c];
      if (!(std::abs(expected - sample[v][c]) <= same_as_fog)) return std::nullopt;
    }
  }
  return entry;
}

}  // namespace

std::optional<MeasuredFog> measure_fog(const std::vector<volume::Rgba>& table, bool premultiplied,
                                       const std::vector<float>& number, const std::array<float, 2>& needed,
                                       const ColoursAlongNumber& colours) {
  Samples seen;
  for (const std::size_t entry : telling_entries(table)) {
    seen.push_back(colours(entry));
    for (volume::Rgba& colour : seen.back()) {
      colour = clamped(colour);
      if (!(std::abs(colour[3] - seen.back().front()[3]) <= same_as_fog)) return std::nullopt;
    }
  }
  if (seen.empty()) return std::nullopt;

  const std::size_t clearest = clearest_number(seen, number, needed);
  MeasuredFog fog;
  fog.reference = number[clearest];
  for (std::size_t v = 0; v < number.size(); v += values_per_entry) {
    if (const auto entry = fog_at(seen, premultiplied, clearest, v)) {
      if (fog.entries.empty()) fog.low = number[v];
      fog.high = number[v];
      fog.entries.push_back(*entry);
    } else if (number[v] > needed[1]) {
      break;
    } else {
      // Below the needed values the fog need not explain the colours, which may be clamped there.
      fog.entries.clear();
    }
  }
  if (fog.entries.size() < 2 || fog.low > needed[0] || fog.high < needed[1]) return std::nullopt;
  return fog;
}

}  // namespace understudy::spu
