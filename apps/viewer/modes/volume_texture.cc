// SPDX-License-Identifier: Apache-2.0
#include "apps/viewer/modes/volume_texture.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/viewer/model/error.h"

namespace viewer {

namespace {

void set_sampling(GLenum target, std::initializer_list<GLenum> wraps) {
  glTexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  for (const GLenum wrap : wraps) glTexParameteri(target, wrap, GL_CLAMP_TO_EDGE);
}

}  // namespace

VolumeTextureFormat luminance_format(TexelFormat format) {
  switch (format) {
    case TexelFormat::unorm8:
      return {GL_LUMINANCE8, GL_LUMINANCE, GL_UNSIGNED_BYTE, "GL_LUMINANCE8"};
    case TexelFormat::unorm16:
      return {GL_LUMINANCE16, GL_LUMINANCE, GL_UNSIGNED_SHORT, "GL_LUMINANCE16"};
    case TexelFormat::float32:
      break;
  }
  return {GL_LUMINANCE32F_ARB, GL_LUMINANCE, GL_FLOAT, "GL_LUMINANCE32F"};
}

VolumeTextureFormat red_format(TexelFormat format) {
  switch (format) {
    case TexelFormat::unorm8:
      return {GL_R8, GL_RED, GL_UNSIGNED_BYTE, "GL_R8"};
    case TexelFormat::unorm16:
      return {GL_R16, GL_RED, GL_UNSIGNED_SHORT, "GL_R16"};
    case TexelFormat::float32:
      break;
  }
  return {GL_R32F, GL_RED, GL_FLOAT, "GL_R32F"};
}

Texture make_volume_texture(const VolumeTextureFormat& format, const VolumeSize& size, const void* data,
                            const std::string& file) {
  GLint limit = 0;
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &limit);
  if (*std::max_element(size.begin(), size.end()) > limit)
    throw Error(ExitCode::bad_file,
                fmt::format("{}: {} voxels along one axis are too many: 3-D textures of this OpenGL driver are "
                            "limited to {} (GL_MAX_3D_TEXTURE_SIZE); crop or downsample the volume",
                            file, text_of(size), limit));
  const auto width = static_cast<GLsizei>(size[0]), height = static_cast<GLsizei>(size[1]),
             depth = static_cast<GLsizei>(size[2]);
  Texture texture = make_texture();
  glBindTexture(GL_TEXTURE_3D, texture.name());
  set_sampling(GL_TEXTURE_3D, {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R});
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);

  // The edges are within the limit; only the driver can tell whether the whole texture fits.
  glTexImage3D(GL_PROXY_TEXTURE_3D, 0, format.internal_format, width, height, depth, 0, format.format,
               format.type, nullptr);
  GLint accepted_width = 0;
  glGetTexLevelParameteriv(GL_PROXY_TEXTURE_3D, 0, GL_TEXTURE_WIDTH, &accepted_width);
  GLenum error = GL_OUT_OF_MEMORY;
  if (accepted_width == width) {
    glTexImage3D(GL_TEXTURE_3D, 0, format.internal_format, width, height, depth, 0, format.format, format.type,
                 data);
    error = glGetError();
  }
  if (error != GL_NO_ERROR)
    throw Error(ExitCode::bad_file,
                fmt::format("{}: OpenGL rejects a {} texture of {} texels (error 0x{:x}): not enough memory; "
                            "downsample the volume, or use --mode table instead of rgba",
                            file, format.name, text_of(size), error));
  return texture;
}

Texture make_table_texture() {
  Texture texture = make_texture();
  glBindTexture(GL_TEXTURE_1D, texture.name());
  set_sampling(GL_TEXTURE_1D, {GL_TEXTURE_WRAP_S});
  return texture;
}

void upload_table(const Texture& texture, const Table& table) {
  glBindTexture(GL_TEXTURE_1D, texture.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage1D(GL_TEXTURE_1D, 0, GL_RGBA8, static_cast<GLsizei>(table.size()), 0, GL_RGBA, GL_UNSIGNED_BYTE,
               table.data());
}

}  // namespace viewer
