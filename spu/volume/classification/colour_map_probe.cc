// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/classification/colour_map_probe.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <utility>

#include "spu/volume/classification/fog.h"
#include "spu/volume/context/context.h"

namespace understudy::spu {
namespace {

/// Returns whether texels in [0,1] may be mapped to colours outside of it.
bool leaves_unit_interval(const std::array<float, 16>& matrix) {
  for (std::size_t row = 0; row < 4; ++row) {
    float low = 0;
    float high = 0;
    for (std::size_t column = 0; column < 4; ++column) {
      low += std::min(matrix[4 * row + column], 0.0F);
      high += std::max(matrix[4 * row + column], 0.0F);
    }
    if (low < -same_colour || high > 1 + same_colour) return true;
  }
  return false;
}

/// The alpha test keeps fragments above this alpha; null if it uses another comparison.
std::optional<float> least_alpha(const DispatchTable& gl) {
  GLint compare = 0;
  GLfloat reference = 0;
  gl.GetIntegerv(GL_ALPHA_TEST_FUNC, &compare);
  gl.GetFloatv(GL_ALPHA_TEST_REF, &reference);
  if (compare == GL_GREATER) return reference;
  if (compare == GL_ALWAYS) return volume::LinearMap{}.alpha_above;
  return std::nullopt;
}

/// Colours all over the unit cube. The first is black, the next have one component each: they give the map's
/// columns.
std::vector<float> some_colours(bool opaque) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  std::vector<float> texels(std::size_t(4) * probe_pixels);
  for (float& x : texels) x = uniform(random);
  std::fill_n(texels.begin(), 20, 0.0F);
  for (std::size_t c = 0; c < 4; ++c) texels[4 * (c + 1) + c] = 1.0F;
  // Colours without alpha have alpha 1 everywhere, and black is mapped to the column of alpha.
  for (std::size_t i = 3; opaque && i < texels.size(); i += 4) texels[i] = 1.0F;
  return texels;
}

/// The matrix, row by row, from what the first texels of some_colours() are mapped to.
std::array<float, 16> matrix_of(const ProbedImage& mapped, bool opaque) {
  std::array<float, 16> matrix{};
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      const float of_alpha = opaque ? mapped[0][row] : 0.0F;
      matrix[4 * row + column] = opaque && column == 3 ? of_alpha : mapped[column + 1][row] - of_alpha;
    }
  }
  return matrix;
}

volume::Rgba mapped_by(const std::array<float, 16>& matrix, const float* texel) {
  volume::Rgba mapped{};
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = 0; column < 4; ++column) mapped[row] += matrix[4 * row + column] * texel[column];
  }
  return mapped;
}

/// Probes the application's fragment pipeline with texels of chosen colours.
class MapProbe {
 public:
  MapProbe(ProbeBench& bench, const GlContext& context, const TextureDescription& texture,
           const FragmentInputs& fragment)
      : bench_(bench),
        context_(context),
        texture_(texture),
        fragment_(fragment),
        texels_(some_colours(texture.opaque)) {}

  const float* texel(std::size_t index) const { return &texels_[4 * index]; }

  /// Returns what all texels are mapped to with `inputs`.
  ProbedImage mapped(const InputValues& inputs) {
    show(probe_edge, texels_);
    return bench_.draw(without_coordinate(fragment_, inputs), false);
  }
  /// Returns what one texel is mapped to while `number` runs from `low` in the first pixel to `high` in the
  /// last.
  ProbedImage along(std::size_t index, const InputNumber& number, float low, float high) {
    show(1, {texel(index), texel(index) + 4});
    return bench_.draw_along(fragment_, number, low, high, false);
  }
  /// Returns what a colour is mapped to at coordinates all over the volume.
  ProbedImage everywhere(const std::array<float, 4>& colour, const InputValues& inputs) {
    show(1, {colour.begin(), colour.end()});
    return bench_.draw(without_coordinate(fragment_, inputs), false);
  }

 private:
  void show(int extent, const std::vector<float>& texels) {
    bench_.show(texture_.opaque ? GL_RGB32F : GL_RGBA32F, GL_RGBA, extent, extent, texels, texture_.swizzle,
                context_.version >= 330);
  }

  ProbeBench& bench_;
  const GlContext& context_;
  const TextureDescription& texture_;
  const FragmentInputs& fragment_;
  std::vector<float> texels_;
};

/// The map where the fog is thinnest, and the fog over it.
struct FoggedMap {
  std::array<float, 16> matrix{};
  std::optional<MeasuredFog> fog;
  volume::Rgba added{};  ///< by the fog where it is thinnest
  InputRange range;
};

bool is_map_of(const FoggedMap& map, const MapProbe& probe, const ProbedImage& mapped) {
  for (std::size_t i = 0; i < probe_pixels; ++i) {
    volume::Rgba expected = mapped_by(map.matrix, probe.texel(i));
    for (std::size_t c = 0; c < 3; ++c) expected[c] += map.added[c];
    if (!(largest_difference(mapped[i], expected) <= same_colour)) return false;
  }
  return true;
}

/// Returns the varying scalars that colours depend on.
std::vector<InputNumber> telling_numbers(MapProbe& probe, const ProbedImage& mapped,
                                         const FragmentInputs& fragment) {
  std::vector<InputNumber> telling;
  for (const InputNumber& number : varying_numbers(fragment)) {
    for (const InputValues* end : {&fragment.range.low, &fragment.range.high}) {
      const float value = (*end)[number.input][number.component];
      if (largest_difference(probe.mapped(with_number(fragment.first, number, value)), mapped) <= same_colour)
        continue;
      telling.push_back(number);
      break;
    }
  }
  return telling;
}

/// Returns whether the fog, which was measured with a few colours, holds for all of them.
bool holds_for_all(MapProbe& probe, const FoggedMap& map, const FragmentInputs& fragment, bool premultiplied) {
  const MeasuredFog& fog = *map.fog;
  const std::size_t last = fog.entries.size() - 1;
  for (const std::size_t k : {std::size_t(0), last / 2, last}) {
    const float value = fog.low + (fog.high - fog.low) * float(k) / float(last);
    const ProbedImage seen = probe.mapped(with_number(fragment.first, {fog.input, fog.component}, value));
    for (std::size_t i = 0; i < seen.size(); ++i) {
      volume::Rgba expected = mapped_by(map.matrix, probe.texel(i));
      for (std::size_t c = 0; c < 3; ++c) {
        const float added = fog.entries[k][c] * (premultiplied ? expected[3] : 1.0F);
        expected[c] = fog.entries[k][3] * expected[c] + added;
      }
      if (!(largest_difference(seen[i], expected) <= same_fogged_colour)) return false;
    }
  }
  return true;
}

/// Returns the fog by `number`, the only scalar that colours depend on, and the map below it; null if colours
/// do not depend on it as on fog.
std::optional<FoggedMap> map_in_fog(MapProbe& probe, const FragmentInputs& fragment, const InputNumber& number,
                                    const ProbedImage& mapped, bool premultiplied, bool opaque) {
  for (const InputRange& tried : {widened(fragment.range, {number}), fragment.range}) {
    const float low = tried.low[number.input][number.component];
    const float high = tried.high[number.input][number.component];
    const std::array<float, 2> needed{fragment.range.low[number.input][number.component],
                                      fragment.range.high[number.input][number.component]};
    std::vector<float> values(probe_pixels);
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = low + (high - low) * float(i) / float(probe_pixels - 1);
    auto fog = measure_fog(mapped, premultiplied, values, needed,
                           [&](std::size_t entry) { return probe.along(entry, number, low, high); });
    if (!fog) continue;
    fog->input = number.input;
    fog->component = number.component;
    ProbedImage clearest = probe.mapped(with_number(fragment.first, number, fog->reference));
    FoggedMap map{.range = tried};
    // Black is mapped to the colour of the fog; if texels have no alpha, that colour is part of the map.
    for (std::size_t c = 0; c < 3 && !opaque; ++c) map.added[c] = clearest.front()[c];
    const ProbedImage seen = clearest;
    for (volume::Rgba& colour : clearest) {
      for (std::size_t c = 0; c < 3; ++c) colour[c] -= map.added[c];
    }
    map.matrix = matrix_of(clearest, opaque);
    for (volume::Rgba& entry : fog->entries) {
      for (std::size_t c = 0; c < 3; ++c) entry[c] += entry[3] * map.added[c];
    }
    map.range.low[number.input][number.component] = fog->low;
    map.range.high[number.input][number.component] = fog->high;
    map.fog = std::move(fog);
    if (is_map_of(map, probe, seen) && holds_for_all(probe, map, fragment, premultiplied)) return map;
  }
  return std::nullopt;
}

}  // namespace

ProbeFinding probe_map(ProbeBench& bench, const GlContext& context, const Pipeline& pipeline,
                       const TextureDescription& texture, const FragmentInputs& fragment) {
  volume::LinearMap map;
  map.multiply_by_alpha = !pipeline.blending.premultiplied;
  if (bench.alpha_test_enabled()) {
    const auto least = least_alpha(*context.gl);
    if (!least) return "the alpha test on a colour volume is not GREATER";
    map.alpha_above = *least;
  }
  MapProbe probe(bench, context, texture, fragment);
  const ProbedImage mapped = probe.mapped(fragment.first);
  if (!bench.drew_any()) return no_fragment_drawn;
  FoggedMap found{.matrix = matrix_of(mapped, texture.opaque), .range = fragment.range};
  InputValues last = fragment.last;
  const std::vector<InputNumber> telling = telling_numbers(probe, mapped, fragment);
  if (telling.size() == 1 && !fragment.inputs[telling.front().input].integer) {
    auto fogged =
        map_in_fog(probe, fragment, telling.front(), mapped, pipeline.blending.premultiplied, texture.opaque);
    if (!fogged) return more_than_the_sample;
    found = *std::move(fogged);
    last = with_number(last, telling.front(), found.fog->reference);
  } else if (!is_map_of(found, probe, mapped)) {
    return "the map of a colour volume is not linear";
  }
  map.matrix = found.matrix;
  if (pipeline.target.floating && leaves_unit_interval(map.matrix))
    return "the colours leave [0,1] in a float framebuffer";
  const std::array<float, 4> texel{0.25F, 0.5F, 0.75F, texture.opaque ? 1.0F : 0.5F};
  volume::Rgba expected = mapped_by(map.matrix, texel.data());
  for (std::size_t c = 0; c < 3; ++c) expected[c] += found.added[c];
  for (const volume::Rgba& colour : probe.everywhere(texel, last)) {
    if (!(largest_difference(colour, expected) <= same_colour)) return more_than_the_sample;
  }
  return Probed{map, found.fog, found.range};
}

}  // namespace understudy::spu
