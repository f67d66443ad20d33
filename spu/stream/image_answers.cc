// SPDX-License-Identifier: Apache-2.0
#include "spu/stream/image_answers.h"

#include "spu/stream/extent.h"

namespace understudy::spu {
namespace {

int dimensions_of(GLenum target) {
  switch (target) {
    case GL_TEXTURE_1D:
      return 1;
    case GL_TEXTURE_3D:
    case GL_TEXTURE_2D_ARRAY:
    case GL_TEXTURE_CUBE_MAP:
    case GL_TEXTURE_CUBE_MAP_ARRAY:
      return 3;
    default:
      return 2;
  }
}

std::optional<ImageAnswer> with_rows(const ImageShape& shape) {
  const auto bytes = image_extent(shape, tight_pixels);
  if (!bytes) return std::nullopt;
  return ImageAnswer{shape, *bytes};
}

/// A level of a texture that is specified by target or by name.
struct Level {
  const DispatchTable& gl;
  bool named;
  GLuint texture_or_target;
  GLint level;

  GLint ask(GLenum name) const {
    GLint value = 0;
    if (named) {
      gl.GetTextureLevelParameteriv(texture_or_target, level, name, &value);
    } else {
      gl.GetTexLevelParameteriv(texture_or_target, level, name, &value);
    }
    return value;
  }
  GLenum target() const {
    if (!named) return texture_or_target;
    GLint target = 0;
    gl.GetTextureParameteriv(texture_or_target, GL_TEXTURE_TARGET, &target);
    return GLenum(target);
  }
  std::optional<ImageAnswer> pixels(GLenum format, GLenum type) const {
    const GLenum of = target();
    const GLint faces = of == GL_TEXTURE_CUBE_MAP ? 6 : 1;
    return with_rows({ask(GL_TEXTURE_WIDTH), ask(GL_TEXTURE_HEIGHT), ask(GL_TEXTURE_DEPTH) * faces, format,
                      type, dimensions_of(of)});
  }
  std::optional<ImageAnswer> compressed() const {
    if (ask(GL_TEXTURE_COMPRESSED) == 0) return std::nullopt;
    const auto bytes = std::size_t(ask(GL_TEXTURE_COMPRESSED_IMAGE_SIZE));
    return ImageAnswer{std::nullopt, target() == GL_TEXTURE_CUBE_MAP ? 6 * bytes : bytes};
  }
};

std::optional<ImageAnswer> pixel_map(const DispatchTable& gl, GLenum map, std::size_t value_bytes) {
  if (map < GL_PIXEL_MAP_I_TO_I || map > GL_PIXEL_MAP_A_TO_A) return std::nullopt;
  GLint size = 0;
  gl.GetIntegerv(GLenum(GL_PIXEL_MAP_I_TO_I_SIZE) + (map - GLenum(GL_PIXEL_MAP_I_TO_I)), &size);
  return ImageAnswer{std::nullopt, std::size_t(size) * value_bytes};
}

std::optional<ImageAnswer> whole_answer(CallId call, const std::uint64_t* words, const DispatchTable& gl) {
  const auto level = GLint(call_shape(call).parameter_count > 1 ? words[1] : 0);
  const Level by_target{gl, false, GLuint(words[0]), level};
  const Level by_name{gl, true, GLuint(words[0]), level};
  switch (call) {
    case CallId::ReadPixels:
    case CallId::ReadnPixels:
    case CallId::ReadnPixelsARB:
    case CallId::GetTextureSubImage:
      return with_rows(image_shape(call, words));
    case CallId::GetTexImage:
    case CallId::GetnTexImage:
    case CallId::GetnTexImageARB:
      return by_target.pixels(GLenum(words[2]), GLenum(words[3]));
    case CallId::GetTextureImage:
      return by_name.pixels(GLenum(words[2]), GLenum(words[3]));
    case CallId::GetCompressedTexImage:
    case CallId::GetCompressedTexImageARB:
    case CallId::GetnCompressedTexImage:
    case CallId::GetnCompressedTexImageARB:
      return by_target.compressed();
    case CallId::GetCompressedTextureImage:
      return by_name.compressed();
    case CallId::GetPolygonStipple:
      return with_rows({32, 32, 1, GL_COLOR_INDEX, GL_BITMAP, 2});
    case CallId::GetPixelMapfv:
    case CallId::GetPixelMapuiv:
      return pixel_map(gl, GLenum(words[0]), 4);
    case CallId::GetPixelMapusv:
      return pixel_map(gl, GLenum(words[0]), 2);
    default:
      return std::nullopt;
  }
}

}  // namespace

std::optional<ImageAnswer> image_answer(CallId call, const std::uint64_t* words, const DispatchTable& gl) {
  auto answer = whole_answer(call, words, gl);
  if (!answer) return std::nullopt;
  // The caller's memory is no larger than bufSize.
  const std::uint8_t room = argument_named(call_shape(call), "bufSize");
  if (room != no_argument && words[room] < answer->bytes) answer->bytes = 0;
  return answer;
}

}  // namespace understudy::spu
