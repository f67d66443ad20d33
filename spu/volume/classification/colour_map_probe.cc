// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/classification/colour_map_probe.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "spu/volume/context/context.h"

namespace understudy::spu {
namespace {

/// Whether texels in [0,1] may give colours outside of it.
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

/// Above which alpha fragments are kept; null where the alpha test is another comparison.
std::optional<float> least_alpha(const DispatchTable& gl) {
  GLint compare = 0;
  GLfloat reference = 0;
  gl.GetIntegerv(GL_ALPHA_TEST_FUNC, &compare);
  gl.GetFloatv(GL_ALPHA_TEST_REF, &reference);
  if (compare == GL_GREATER) return reference;
  if (compare == GL_ALWAYS) return volume::LinearMap{}.alpha_above;
  return std::nullopt;
}

/// Colours all over the unit cube: black first, then each component alone, the columns of a map.
std::vector<float> some_colours(bool opaque) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  std::vector<float> texels(std::size_t(4) * probe_pixels);
  for (float& x : texels) x = uniform(random);
  std::fill_n(texels.begin(), 20, 0.0F);
  for (std::size_t c = 0; c < 4; ++c) texels[4 * (c + 1) + c] = 1.0F;
  // Colours without alpha have one everywhere, and what black gives is that alpha's column.
  for (std::size_t i = 3; opaque && i < texels.size(); i += 4) texels[i] = 1.0F;
  return texels;
}

/// Row by row, from what the first texels of some_colours() became.
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

bool is_map_of(const std::array<float, 16>& matrix, const std::vector<float>& texels,
               const ProbedImage& mapped) {
  for (std::size_t i = 0; i < probe_pixels; ++i) {
    volume::Rgba expected{};
    for (std::size_t row = 0; row < 4; ++row) {
      for (std::size_t column = 0; column < 4; ++column) {
        expected[row] += matrix[4 * row + column] * texels[4 * i + column];
      }
    }
    if (!(largest_difference(mapped[i], expected) <= same_colour)) return false;
  }
  return true;
}

/// Whether all of `image`, drawn of one texel, has that texel's colour.
bool is_constant(const std::array<float, 16>& matrix, const std::array<float, 4>& texel,
                 const ProbedImage& image) {
  for (std::size_t row = 0; row < 4; ++row) {
    const float* m = &matrix[4 * row];
    const float expected = texel[0] * m[0] + texel[1] * m[1] + texel[2] * m[2] + texel[3] * m[3];
    for (const volume::Rgba& colour : image) {
      if (!(std::abs(colour[row] - expected) <= same_colour)) return false;
    }
  }
  return true;
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
  const bool with_swizzle = context.version >= 330;
  const GLenum format = texture.opaque ? GL_RGB32F : GL_RGBA32F;
  const std::vector<float> texels = some_colours(texture.opaque);
  bench.show(format, GL_RGBA, probe_edge, probe_edge, texels, texture.swizzle, with_swizzle);
  const ProbedImage mapped = bench.draw(without_coordinate(fragment, fragment.first), false);
  map.matrix = matrix_of(mapped, texture.opaque);
  if (!is_map_of(map.matrix, texels, mapped)) return "the map of a colour volume is not linear";
  if (pipeline.target.floating && leaves_unit_interval(map.matrix))
    return "the colours leave [0,1] in a float framebuffer";
  const std::array<float, 4> texel{0.25F, 0.5F, 0.75F, texture.opaque ? 1.0F : 0.5F};
  bench.show(format, GL_RGBA, 1, 1, {texel.begin(), texel.end()}, texture.swizzle, with_swizzle);
  const ProbedImage constant = bench.draw(without_coordinate(fragment, fragment.last), false);
  if (!is_constant(map.matrix, texel, constant))
    return "the colour depends on more than the sample (position, lighting)";
  return Probed{map, std::nullopt, fragment.range};
}

}  // namespace understudy::spu
