// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/proxy/table_contents.h"

#include <algorithm>
#include <cmath>

#include "spu/volume/context/context.h"
#include "spu/volume/context/saved_state.h"

namespace understudy::spu {
namespace {

constexpr GLint largest_edge = 4096;
constexpr GLint most_texels = 65536;

std::vector<float> texels_of(const GlContext& context, const SampledTexture& table) {
  if (table.texture == 0 || (table.target != GL_TEXTURE_1D && table.target != GL_TEXTURE_2D)) return {};
  const DispatchTable& gl = *context.gl;
  SavedState saved(context);
  saved.borrow_texture(table.target, table.unit);
  gl.BindTexture(table.target, table.texture);
  GLint width = 0;
  GLint height = 0;
  gl.GetTexLevelParameteriv(table.target, 0, GL_TEXTURE_WIDTH, &width);
  gl.GetTexLevelParameteriv(table.target, 0, GL_TEXTURE_HEIGHT, &height);
  if (width < 1 || height < 1 || std::max(width, height) > largest_edge || width * height > most_texels)
    return {};
  std::vector<float> rgba(4 * std::size_t(width) * std::size_t(height));
  gl.GetTexImage(table.target, 0, GL_RGBA, GL_FLOAT, rgba.data());
  return rgba;
}

}  // namespace

std::vector<TableContents> table_contents(const GlContext& context, const Run& run,
                                          std::span<const std::string> samplers) {
  std::vector<TableContents> contents;
  for (const std::string& name : samplers) {
    const GLint location = context.gl->GetUniformLocation(run.pipeline().program, name.c_str());
    for (const SampledTexture& table : run.pipeline().others) {
      if (table.sampler_location == location) contents.push_back({location, texels_of(context, table)});
    }
  }
  return contents;
}

bool only_corrected(std::span<const TableContents> before, std::span<const TableContents> now, double factor) {
  // Half a step of 8 bits, plus the application's own rounding.
  constexpr double tolerance = 0.0025;
  const auto corrected = [&](const TableContents& then, const TableContents& today) {
    if (then.sampler_location != today.sampler_location || today.rgba.empty()) return false;
    return std::ranges::equal(then.rgba, today.rgba, [&](float was, float is) {
      const double opacity = std::clamp(double(was), 0.0, 1.0);
      return was == is || std::abs(1 - std::pow(1 - opacity, factor) - double(is)) <= tolerance;
    });
  };
  return std::ranges::equal(before, now, corrected);
}

}  // namespace understudy::spu
