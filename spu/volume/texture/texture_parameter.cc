// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/texture/texture_parameter.h"

#include <array>
#include <bit>
#include <cstdint>

#include "spu/volume/context/context.h"

namespace understudy::spu {
namespace {

bool is_table_target(GLenum target) {
  return target == GL_TEXTURE_1D || target == GL_TEXTURE_2D || target == GL_TEXTURE_RECTANGLE;
}

/// Makes a texture unit active, and the earlier one when it goes out of scope.
class ActiveUnit {
 public:
  ActiveUnit(const DispatchTable& gl, int unit) : gl_(gl) {
    gl_.GetIntegerv(GL_ACTIVE_TEXTURE, &before_);
    gl_.ActiveTexture(GLenum(GL_TEXTURE0 + unit));
  }
  ~ActiveUnit() { gl_.ActiveTexture(GLenum(before_)); }
  ActiveUnit(const ActiveUnit&) = delete;
  ActiveUnit& operator=(const ActiveUnit&) = delete;

 private:
  const DispatchTable& gl_;
  GLint before_ = GL_TEXTURE0;
};

GLfloat float_parameter(const DispatchTable& gl, GLenum target, GLint sampler, GLenum name) {
  GLfloat value = 0;
  if (sampler != 0) {
    gl.GetSamplerParameterfv(GLuint(sampler), name, &value);
  } else {
    gl.GetTexParameterfv(target, name, &value);
  }
  return value;
}

bool is_anisotropic(const GlContext& context, GLenum target, GLint sampler) {
  return context.anisotropic_filter &&
         float_parameter(*context.gl, target, sampler, GL_TEXTURE_MAX_ANISOTROPY) > 1;
}

GLint without_mipmaps(GLint filter) {
  switch (filter) {
    case GL_NEAREST_MIPMAP_NEAREST:
    case GL_NEAREST_MIPMAP_LINEAR:
      return GL_NEAREST;
    case GL_LINEAR_MIPMAP_NEAREST:
    case GL_LINEAR_MIPMAP_LINEAR:
      return GL_LINEAR;
    default:
      return filter;
  }
}

/// Returns an extent of a level of the bound texture; 0 if it has no such level.
GLint extent_of_level(const DispatchTable& gl, GLenum target, GLint level, GLenum name) {
  GLint largest = 0;
  gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  GLint extent = 0;
  if (level < int(std::bit_width(unsigned(largest)))) gl.GetTexLevelParameteriv(target, level, name, &extent);
  return extent;
}

/// The levels of the bound texture that a mipmap filter may take. None: the texture lacks some, and has one
/// colour everywhere.
enum class Levels : std::uint8_t { none, one, several };

Levels levels_of(const GlContext& context, GLenum target) {
  const DispatchTable& gl = *context.gl;
  const GLint base = texture_parameter(gl, target, 0, GL_TEXTURE_BASE_LEVEL);
  if (texture_parameter(gl, target, 0, GL_TEXTURE_MAX_LEVEL) <= base) return Levels::one;
  if (extent_of_level(gl, target, base + 1, GL_TEXTURE_WIDTH) > 0) return Levels::several;
  const bool immutable =
      context.version >= 420 && texture_parameter(gl, target, 0, GL_TEXTURE_IMMUTABLE_FORMAT) != 0;
  return immutable ? Levels::one : Levels::none;
}

bool is_one_texel(const GlContext& context, GLenum target) {
  const DispatchTable& gl = *context.gl;
  const GLint base = texture_parameter(gl, target, 0, GL_TEXTURE_BASE_LEVEL);
  return extent_of_level(gl, target, base, GL_TEXTURE_WIDTH) == 1 &&
         extent_of_level(gl, target, base, GL_TEXTURE_HEIGHT) == 1;
}

}  // namespace

GLint bound_sampler(const GlContext& context) {
  GLint sampler = 0;
  if (context.version >= 330) context.gl->GetIntegerv(GL_SAMPLER_BINDING, &sampler);
  return sampler;
}

GLint texture_parameter(const DispatchTable& gl, GLenum target, GLint sampler, GLenum name) {
  GLint value = 0;
  if (sampler != 0) {
    gl.GetSamplerParameteriv(GLuint(sampler), name, &value);
  } else {
    gl.GetTexParameteriv(target, name, &value);
  }
  return value;
}

bool decodes_srgb(const GlContext& context, GLenum target, GLint sampler) {
  return !context.srgb_decode ||
         texture_parameter(*context.gl, target, sampler, GL_TEXTURE_SRGB_DECODE_EXT) != GL_SKIP_DECODE_EXT;
}

bool depends_on_level_of_detail(const GlContext& context, GLenum target, int unit) {
  if (!is_table_target(target)) return false;
  const ActiveUnit active(*context.gl, unit);
  const DispatchTable& gl = *context.gl;
  const GLint sampler = bound_sampler(context);
  const GLint minify = texture_parameter(gl, target, sampler, GL_TEXTURE_MIN_FILTER);
  const GLint magnify = texture_parameter(gl, target, sampler, GL_TEXTURE_MAG_FILTER);
  const bool anisotropic = is_anisotropic(context, target, sampler);
  if (minify == magnify && !anisotropic) return false;
  // Up to level 0, textures are magnified.
  if (float_parameter(gl, target, sampler, GL_TEXTURE_MAX_LOD) <= 0) return false;
  const bool mipmapped = minify != GL_NEAREST && minify != GL_LINEAR;
  const Levels levels = mipmapped ? levels_of(context, target) : Levels::one;
  if (levels == Levels::none || is_one_texel(context, target)) return false;
  return levels == Levels::several || without_mipmaps(minify) != magnify || anisotropic;
}

void append_lookup(const GlContext& context, GLenum target, int unit, std::vector<float>& values) {
  if (!is_table_target(target)) return;
  const DispatchTable& gl = *context.gl;
  const ActiveUnit active(gl, unit);
  const GLint sampler = bound_sampler(context);
  for (const GLenum name : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER, GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    values.push_back(float(texture_parameter(gl, target, sampler, name)));
  for (const GLenum name : {GL_TEXTURE_MIN_LOD, GL_TEXTURE_MAX_LOD, GL_TEXTURE_LOD_BIAS})
    values.push_back(float_parameter(gl, target, sampler, name));
  if (context.anisotropic_filter)
    values.push_back(float_parameter(gl, target, sampler, GL_TEXTURE_MAX_ANISOTROPY));
  if (!context.core) {
    GLfloat bias = 0;  // of the unit
    gl.GetTexEnvfv(GL_TEXTURE_FILTER_CONTROL, GL_TEXTURE_LOD_BIAS, &bias);
    values.push_back(bias);
  }
  std::array<GLfloat, 4> border{};
  if (sampler != 0)
    gl.GetSamplerParameterfv(GLuint(sampler), GL_TEXTURE_BORDER_COLOR, border.data());
  else
    gl.GetTexParameterfv(target, GL_TEXTURE_BORDER_COLOR, border.data());
  values.insert(values.end(), border.begin(), border.end());
  for (const GLenum name : {GL_TEXTURE_BASE_LEVEL, GL_TEXTURE_MAX_LEVEL})
    values.push_back(float(texture_parameter(gl, target, 0, name)));
  if (context.version >= 330) {
    std::array<GLint, 4> swizzle{};
    gl.GetTexParameteriv(target, GL_TEXTURE_SWIZZLE_RGBA, swizzle.data());
    values.insert(values.end(), swizzle.begin(), swizzle.end());
  }
  values.push_back(decodes_srgb(context, target, sampler) ? 1.0F : 0.0F);
}

}  // namespace understudy::spu
