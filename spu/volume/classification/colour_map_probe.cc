#include "spu/volume/classification/colour_map_probe.h"

#include <algorithm>
#include <cmath>
#include <random>

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

}  // namespace

ProbeFinding probe_map(ProbeBench& bench, const GlContext& context, const Pipeline& pipeline,
                       const TextureDescription& texture, const FragmentInputs& fragment) {
  volume::LinearMap map;
  map.multiply_by_alpha = !pipeline.blending.premultiplied;
  if (bench.alpha_test_enabled()) {
    const DispatchTable& gl = *context.gl;
    GLint compare = 0;
    GLfloat reference = 0;
    gl.GetIntegerv(GL_ALPHA_TEST_FUNC, &compare);
    gl.GetFloatv(GL_ALPHA_TEST_REF, &reference);
    if (compare == GL_GREATER) {
      map.alpha_above = reference;
    } else if (compare != GL_ALWAYS) {
      return "the alpha test on a colour volume is not GREATER";
    }
  }
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  std::vector<float> texels(std::size_t(4) * probe_pixels);
  for (float& x : texels) x = uniform(random);
  // Black, then each component alone: the columns of the map.
  std::fill_n(texels.begin(), 20, 0.0F);
  for (std::size_t c = 0; c < 4; ++c) texels[4 * (c + 1) + c] = 1.0F;
  // Colours without alpha have one everywhere, and what black gives is that alpha's column.
  for (std::size_t i = 3; texture.opaque && i < texels.size(); i += 4) texels[i] = 1.0F;
  const GLenum format = texture.opaque ? GL_RGB32F : GL_RGBA32F;
  bench.show(format, GL_RGBA, probe_edge, probe_edge, texels, texture.swizzle, context.version >= 330);
  const ProbedImage mapped = bench.draw(without_coordinate(fragment, fragment.first), false);
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      const float of_alpha = texture.opaque ? mapped[0][row] : 0.0F;
      map.matrix[4 * row + column] =
          texture.opaque && column == 3 ? of_alpha : mapped[column + 1][row] - of_alpha;
    }
  }
  for (std::size_t i = 0; i < probe_pixels; ++i) {
    volume::Rgba expected{};
    for (std::size_t row = 0; row < 4; ++row) {
      for (std::size_t column = 0; column < 4; ++column) {
        expected[row] += map.matrix[4 * row + column] * texels[4 * i + column];
      }
    }
    if (!(largest_difference(mapped[i], expected) <= same_colour))
      return "the map of a colour volume is not linear";
  }
  if (pipeline.target.floating && leaves_unit_interval(map.matrix))
    return "the colours leave [0,1] in a float framebuffer";
  const float alpha = texture.opaque ? 1.0F : 0.5F;
  bench.show(format, GL_RGBA, 1, 1, {0.25F, 0.5F, 0.75F, alpha}, texture.swizzle, context.version >= 330);
  const ProbedImage constant = bench.draw(without_coordinate(fragment, fragment.last), false);
  for (std::size_t row = 0; row < 4; ++row) {
    const float* m = &map.matrix[4 * row];
    const float expected = 0.25F * m[0] + 0.5F * m[1] + 0.75F * m[2] + alpha * m[3];
    for (const volume::Rgba& colour : constant) {
      if (!(std::abs(colour[row] - expected) <= same_colour)) {
        return "the colour depends on more than the sample (position, lighting)";
      }
    }
  }
  return Probed{map, std::nullopt, fragment.range};
}

}  // namespace understudy::spu
