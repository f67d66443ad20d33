// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/classification/segment_probe.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spu/volume/classification/pre_integration.h"
#include "spu/volume/context/context.h"
#include "volume/blending_operator.h"

namespace understudy::spu {
namespace {

/// Probes segments whose ends are known: the coordinate runs through the middle layer of three, and the input
/// that may address the volume a second time through the lowest.
class SegmentProbe {
 public:
  SegmentProbe(ProbeBench& bench, const GlContext& context, const TextureDescription& texture,
               const FragmentInputs& fragment, std::size_t end)
      : bench_(bench), context_(context), texture_(texture), fragment_(fragment), end_(end) {}

  ProbedImage pairs(const SegmentValues& front, const SegmentValues& back, const InputValues& inputs) {
    std::vector<float> texels(back.begin(), back.end());
    texels.insert(texels.end(), front.begin(), front.end());
    texels.insert(texels.end(), front.begin(), front.end());
    show({probe_edge, 1, 3}, texels, GL_NEAREST);
    return draw(inputs, {0, 0.5F, in_lowest_layer, 1}, {}, {1, 0, 0, 0});
  }
  /// One pair of values, at coordinates all over the volume.
  ProbedImage everywhere(float front, float back, const InputValues& inputs) {
    show({1, 1, 3}, {back, front, front}, GL_NEAREST);
    return draw(inputs, {0, 0, in_lowest_layer, 1}, {0.7F, 0.2F, 0, 0}, {0.1F, 0.8F, 0, 0});
  }
  /// Texels that increase along all axes; the second sample is offset from the first by `off`.
  ProbedImage slope(const std::vector<float>& texels, const std::array<float, 3>& off) {
    show({2, 2, 2}, texels, GL_LINEAR);
    return draw(fragment_.first, {off[0], off[1], 0.5F + off[2], 1}, {1, 0, 0, 0}, {0, 1, 0, 0});
  }

 private:
  static constexpr float in_lowest_layer = 1.0F / 6;

  void show(const std::array<int, 3>& size, const std::vector<float>& texels, GLenum filter) {
    bench_.show(probe_format(texture_.base), upload_format(texture_.base), size, texels, filter,
                texture_.swizzle, context_.version >= 330);
  }
  ProbedImage draw(InputValues inputs, const std::array<float, 4>& end, const std::array<float, 4>& end_across,
                   const std::array<float, 4>& end_up) {
    InputValues across(inputs.size());
    InputValues up(inputs.size());
    inputs[end_] = end;
    across[end_] = end_across;
    up[end_] = end_up;
    return bench_.draw(without_coordinate(fragment_, inputs), true, {}, without_coordinate(fragment_, across),
                       without_coordinate(fragment_, up));
  }

  ProbeBench& bench_;
  const GlContext& context_;
  const TextureDescription& texture_;
  const FragmentInputs& fragment_;
  std::size_t end_;
};

/// Returns whether segments in a field with a slope have colours that the table does not have for their ends.
bool slice_segments_see_neighbours(SegmentProbe& probe, const volume::PreIntegrationTable& table) {
  constexpr double weight_error = 4.0 / 510;  // hardware may use 8-bit interpolation weights
  constexpr std::array<double, 3> slope{1.0 / 6, 2.0 / 6, 3.0 / 6};
  constexpr std::array<float, 3> off{0.03F, -0.05F, 0.04F};
  const double extent = double(table.high) - table.low;
  std::vector<float> texels;
  for (int i = 0; i < 8; ++i) {
    const double place = (i & 1) * slope[0] + (i >> 1 & 1) * slope[1] + (i >> 2) * slope[2];
    texels.push_back(float(table.low + place * extent));
  }
  const ProbedImage image = probe.slope(texels, off);
  constexpr int rim = probe_edge / 4 + 6;
  for (int y = rim; y < probe_edge - rim; ++y) {
    for (int x = rim; x < probe_edge - rim; ++x) {
      const auto place = [&](double away) {
        const std::array<double, 3> at{(x + 0.5) / probe_edge + away * off[0],
                                       (y + 0.5) / probe_edge + away * off[1], 0.5 + away * off[2]};
        double sum = 0;
        for (std::size_t k = 0; k < 3; ++k) sum += slope[k] * (2 * at[k] - 0.5);
        return sum;
      };
      const auto [low, high] = colours_around(table, place(0), place(1), weight_error * (table.edge - 1));
      const volume::Rgba& colour = image[std::size_t(y) * probe_edge + std::size_t(x)];
      for (std::size_t c = 0; c < 4; ++c) {
        if (!(colour[c] >= low[c] - same_fogged_colour && colour[c] <= high[c] + same_fogged_colour))
          return true;
      }
    }
  }
  return false;
}

/// Returns values spread over the range.
SegmentValues spread_over(const std::array<float, 2>& range) {
  SegmentValues spread{};
  for (std::size_t i = 0; i < spread.size(); ++i) {
    const double place = double(i) / double(spread.size() - 1);
    spread[i] = float(range[0] + place * (double(range[1]) - range[0]));
  }
  return spread;
}

/// Returns whether pairs have the colours of `some`, the image of all pairs, at all coordinates.
bool same_everywhere(SegmentProbe& probe, const SegmentValues& spread, const ProbedImage& some,
                     const InputValues& inputs) {
  for (const std::size_t front : {std::size_t(0), segment_tile / 5, segment_tile / 2, segment_tile - 1}) {
    for (const std::size_t back : {std::size_t(0), segment_tile / 3, 4 * segment_tile / 5, segment_tile - 1}) {
      for (const volume::Rgba& colour : probe.everywhere(spread[front], spread[back], inputs)) {
        if (!(largest_difference(colour, some[back * segment_tile + front]) <= same_colour)) return false;
      }
    }
  }
  return true;
}

/// Returns whether they still do while scalars other than those of input `end` run over `range`.
bool same_over(SegmentProbe& probe, const SegmentValues& spread, const ProbedImage& some,
               const FragmentInputs& fragment, const InputRange& range, std::size_t end) {
  for (const InputNumber& number : varying_numbers(fragment)) {
    if (number.input == end) continue;
    for (const InputValues* bound : {&range.low, &range.high}) {
      InputValues inputs = fragment.first;
      inputs[number.input][number.component] = (*bound)[number.input][number.component];
      if (!(largest_difference(probe.pairs(spread, spread, inputs), some) <= same_colour)) return false;
    }
  }
  return true;
}

}  // namespace

std::optional<Probed> probe_segments(ProbeBench& bench, const GlContext& context, const Pipeline& pipeline,
                                     const TextureDescription& texture, const FragmentInputs& fragment,
                                     const std::array<float, 2>& range, std::size_t end) {
  if (pipeline.blending.op == volume::Operator::min || pipeline.blending.alpha.op == volume::Operator::min)
    return std::nullopt;
  SegmentProbe probe(bench, context, texture, fragment, end);
  const SegmentValues spread = spread_over(range);
  const ProbedImage some = probe.pairs(spread, spread, fragment.first);
  if (!bench.drew_any()) return std::nullopt;
  if (!finite(some) || !same_everywhere(probe, spread, some, fragment.first) ||
      !same_everywhere(probe, spread, some, fragment.last))
    return std::nullopt;
  Probed probed;
  probed.range = widened(fragment.range, varying_numbers(fragment));
  if (!same_over(probe, spread, some, fragment, probed.range, end)) return std::nullopt;
  volume::PreIntegrationTable table =
      measure_segments([&](const SegmentValues& front,
                           const SegmentValues& back) { return probe.pairs(front, back, fragment.first); },
                       range, pipeline.blending.premultiplied);
  if (!finite(table.entries) || slice_segments_see_neighbours(probe, table)) return std::nullopt;
  for (volume::Rgba& entry : table.entries) {
    if (!clamp_as_stored(entry, pipeline.target.floating)) return std::nullopt;
  }
  // The geometry decides where the second sample lies, and may change.
  probed.range.low[end].fill(std::numeric_limits<float>::lowest());
  probed.range.high[end].fill(std::numeric_limits<float>::max());
  probed.segment_end = end;
  probed.classification = std::move(table);
  return probed;
}

}  // namespace understudy::spu
