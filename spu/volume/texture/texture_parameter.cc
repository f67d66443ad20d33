// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/texture/texture_parameter.h"

#include <array>

#include "spu/volume/context/context.h"

namespace understudy::spu {

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

void append_lookup(const GlContext& context, GLenum target, int unit, std::vector<float>& values) {
  const DispatchTable& gl = *context.gl;
  if (target != GL_TEXTURE_1D && target != GL_TEXTURE_2D && target != GL_TEXTURE_RECTANGLE) return;
  GLint active = 0;
  gl.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
  gl.ActiveTexture(GLenum(GL_TEXTURE0 + unit));
  const GLint sampler = bound_sampler(context);
  for (const GLenum name : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER, GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    values.push_back(float(texture_parameter(gl, target, sampler, name)));
  std::array<GLfloat, 4> border{};
  if (sampler != 0)
    gl.GetSamplerParameterfv(GLuint(sampler), GL_TEXTURE_BORDER_COLOR, border.data());
  else
    gl.GetTexParameterfv(target, GL_TEXTURE_BORDER_COLOR, border.data());
  values.insert(values.end(), border.begin(), border.end());
  values.push_back(float(texture_parameter(gl, target, 0, GL_TEXTURE_BASE_LEVEL)));
  if (context.version >= 330) {
    std::array<GLint, 4> swizzle{};
    gl.GetTexParameteriv(target, GL_TEXTURE_SWIZZLE_RGBA, swizzle.data());
    values.insert(values.end(), swizzle.begin(), swizzle.end());
  }
  values.push_back(decodes_srgb(context, target, sampler) ? 1.0F : 0.0F);
  gl.ActiveTexture(GLenum(active));
}

}  // namespace understudy::spu
