// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/pipeline/target.h"

namespace understudy::spu {

Target read_target(const DispatchTable& gl) {
  Target target;
  GLint buffer = 0;
  gl.GetIntegerv(GL_DRAW_BUFFER0, &buffer);
  if (buffer == GL_NONE) return target;
  GLenum attachment = GLenum(buffer);
  // Buffers of a window must be queried one by one, not by the names that mean several.
  if (buffer == GL_BACK || buffer == GL_FRONT_AND_BACK) attachment = GL_BACK_LEFT;
  if (buffer == GL_FRONT || buffer == GL_LEFT) attachment = GL_FRONT_LEFT;
  const auto parameter = [&](GLenum name) {
    GLint value = 0;
    gl.GetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, attachment, name, &value);
    return value;
  };
  if (parameter(GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE) == GL_NONE) return target;
  target.alpha_bits = parameter(GL_FRAMEBUFFER_ATTACHMENT_ALPHA_SIZE);
  const auto type = GLenum(parameter(GL_FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE));
  target.normalised = type == GL_UNSIGNED_NORMALIZED;
  target.floating = type == GL_FLOAT;
  GLint multisampled = 0;
  gl.GetIntegerv(GL_SAMPLE_BUFFERS, &multisampled);
  if (multisampled > 0) gl.GetIntegerv(GL_SAMPLES, &target.samples);
  return target;
}

}  // namespace understudy::spu
