// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/texture/texture_parameter.h"

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

}  // namespace understudy::spu
