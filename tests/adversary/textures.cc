// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/textures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace adversary {
namespace {

/// Texels as they are passed to OpenGL.
struct Pixels {
  GLenum type = GL_FLOAT;
  std::vector<std::uint8_t> bytes;
};

template <typename Number>
Pixels converted(const std::vector<float>& values, GLenum type, float scale) {
  Pixels pixels{type, std::vector<std::uint8_t>(values.size() * sizeof(Number))};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto number = static_cast<Number>(scale == 0 ? values[i] : std::round(scale * values[i]));
    std::memcpy(pixels.bytes.data() + i * sizeof(Number), &number, sizeof(Number));
  }
  return pixels;
}

float scale_of(Texel texel) {
  constexpr std::array<float, 5> scales{255, 65535, 32767, 0, 0};
  return scales[static_cast<std::size_t>(texel)];
}

/// Converts the grid to texels; in the exact reference, to floats of the same values.
Pixels pixels_of(const Canvas& canvas, const Grid& grid, Texel texel) {
  const float scale = scale_of(texel);
  if (canvas.exact() && scale != 0) {
    std::vector<float> values = grid.values;
    for (float& value : values) value = std::round(scale * value) / scale;
    return converted<float>(values, GL_FLOAT, 0);
  }
  switch (texel) {
    case Texel::unsigned8:
      return converted<std::uint8_t>(grid.values, GL_UNSIGNED_BYTE, scale);
    case Texel::unsigned16:
      return converted<std::uint16_t>(grid.values, GL_UNSIGNED_SHORT, scale);
    case Texel::signed16:
      return converted<std::int16_t>(grid.values, GL_SHORT, scale);
    default:
      return converted<float>(grid.values, GL_FLOAT, 0);
  }
}

GLenum internal_format(const Canvas& canvas, VolumeFormat format) {
  using Row = std::array<GLenum, 5>;
  constexpr std::array<Row, 4> formats{
      Row{GL_R8, GL_R16, GL_R16_SNORM, GL_R16F, GL_R32F},
      Row{GL_LUMINANCE8, GL_LUMINANCE16, GL_LUMINANCE16_SNORM, GL_LUMINANCE16F_ARB, GL_LUMINANCE32F_ARB},
      Row{GL_INTENSITY8, GL_INTENSITY16, GL_INTENSITY16_SNORM, GL_INTENSITY16F_ARB, GL_INTENSITY32F_ARB},
      Row{GL_RGBA8, GL_RGBA16, GL_RGBA16_SNORM, GL_RGBA16F, GL_RGBA32F}};
  const bool as_float = canvas.exact() && scale_of(format.texel) != 0;
  const Texel texel = as_float ? Texel::float32 : format.texel;
  return formats[static_cast<std::size_t>(format.shown)][static_cast<std::size_t>(texel)];
}

GLenum pixel_format(Shown shown) {
  constexpr std::array<GLenum, 4> formats{GL_RED, GL_LUMINANCE, GL_LUMINANCE, GL_RGBA};
  return formats[static_cast<std::size_t>(shown)];
}

GLuint bound_texture(const Canvas& canvas, int unit, GLenum target, GLenum filter) {
  GLuint name = 0;
  canvas.gl.GenTextures(1, &name);
  canvas.gl.ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  canvas.gl.BindTexture(target, name);
  filter_linearly(canvas, target, filter);
  canvas.gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  return name;
}

}  // namespace

void filter_linearly(const Canvas& canvas, GLenum target, GLenum filter) {
  for (const GLenum name : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    canvas.gl.TexParameteri(target, name, static_cast<GLint>(filter));
  for (const GLenum name : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    canvas.gl.TexParameteri(target, name, GL_CLAMP_TO_EDGE);
}

GLuint upload_volume(const Canvas& canvas, int unit, const Grid& grid, VolumeFormat format) {
  const GLuint name = bound_texture(canvas, unit, GL_TEXTURE_3D, format.filter);
  const Pixels pixels = pixels_of(canvas, grid, format.texel);
  canvas.gl.TexImage3D(GL_TEXTURE_3D, 0, static_cast<GLint>(internal_format(canvas, format)), grid.x, grid.y,
                       grid.z, 0, pixel_format(format.shown), pixels.type, pixels.bytes.data());
  return name;
}

void replace_texels(const Canvas& canvas, const Grid& grid, VolumeFormat format, int x, int y, int z) {
  const Pixels pixels = pixels_of(canvas, grid, format.texel);
  canvas.gl.TexSubImage3D(GL_TEXTURE_3D, 0, x, y, z, grid.x, grid.y, grid.z, pixel_format(format.shown),
                          pixels.type, pixels.bytes.data());
}

GLuint upload_labels(const Canvas& canvas, int unit, const Grid& grid) {
  const GLuint name = bound_texture(canvas, unit, GL_TEXTURE_3D, GL_NEAREST);
  const Pixels pixels = converted<std::uint8_t>(grid.values, GL_UNSIGNED_BYTE, 0);
  canvas.gl.TexImage3D(GL_TEXTURE_3D, 0, GL_R8UI, grid.x, grid.y, grid.z, 0, GL_RED_INTEGER, GL_UNSIGNED_BYTE,
                       pixels.bytes.data());
  return name;
}

GLuint upload_table_1d(const Canvas& canvas, int unit, const std::vector<Colour>& colours) {
  const GLuint name = bound_texture(canvas, unit, GL_TEXTURE_1D, GL_LINEAR);
  canvas.gl.TexImage1D(GL_TEXTURE_1D, 0, GL_RGBA8, static_cast<GLsizei>(colours.size()), 0, GL_RGBA,
                       GL_UNSIGNED_BYTE, colours.data());
  return name;
}

GLuint upload_table_2d(const Canvas& canvas, int unit, const std::vector<Colour>& colours, int rows,
                       GLenum filter) {
  const GLuint name = bound_texture(canvas, unit, GL_TEXTURE_2D, filter);
  canvas.gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, static_cast<GLsizei>(colours.size()) / rows, rows, 0,
                       GL_RGBA, GL_UNSIGNED_BYTE, colours.data());
  return name;
}

GLuint upload_mask_2d(const Canvas& canvas, int unit, const std::vector<std::uint8_t>& values, int columns) {
  const GLuint name = bound_texture(canvas, unit, GL_TEXTURE_2D, GL_NEAREST);
  canvas.gl.TexImage2D(GL_TEXTURE_2D, 0, GL_R8, columns, static_cast<GLsizei>(values.size()) / columns, 0,
                       GL_RED, GL_UNSIGNED_BYTE, values.data());
  return name;
}

}  // namespace adversary
