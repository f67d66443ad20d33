// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// What holds the depth of a framebuffer object: GL_TEXTURE, GL_RENDERBUFFER, or GL_NONE.
struct DepthAttachment {
  GLenum type = GL_NONE;
  GLuint name = 0;

  /// 0: it is none.
  GLuint renderbuffer() const { return type == GL_RENDERBUFFER ? name : 0; }
};

/// Of `framebuffer`, which is bound for drawing. None of the window's, 0.
DepthAttachment depth_attachment(const DispatchTable& gl, GLuint framebuffer);

}  // namespace understudy::spu
