// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// The depth attachment of a framebuffer object: GL_TEXTURE, GL_RENDERBUFFER, or GL_NONE.
struct DepthAttachment {
  GLenum type = GL_NONE;
  GLuint name = 0;

  /// 0 if the attachment is no renderbuffer.
  GLuint renderbuffer() const { return type == GL_RENDERBUFFER ? name : 0; }
};

/// Returns the attachment of `framebuffer`, which is bound for drawing; none for the window, 0.
DepthAttachment depth_attachment(const DispatchTable& gl, GLuint framebuffer);

}  // namespace understudy::spu
