// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/depth/depth_attachment.h"

namespace understudy::spu {

DepthAttachment depth_attachment(const DispatchTable& gl, GLuint framebuffer) {
  if (framebuffer == 0) return {};
  const auto attached = [&](GLenum what) {
    GLint value = 0;
    gl.GetFramebufferAttachmentParameteriv(GL_DRAW_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, what, &value);
    return GLuint(value);
  };
  const GLenum type = attached(GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE);
  if (type == GL_NONE) return {};
  return {type, attached(GL_FRAMEBUFFER_ATTACHMENT_OBJECT_NAME)};
}

}  // namespace understudy::spu
