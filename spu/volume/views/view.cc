// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/views/view.h"

#include "spu/volume/context/context.h"

namespace understudy::spu {

View current_view(const GlContext& context, GLuint texture, std::uintptr_t window) {
  const DispatchTable& gl = *context.gl;
  const auto integer = [&](GLenum name) {
    GLint value = 0;
    gl.GetIntegerv(name, &value);
    return value;
  };
  View view{.context = &context,
            .texture = texture,
            .window = window,
            .framebuffer = GLuint(integer(GL_DRAW_FRAMEBUFFER_BINDING)),
            .buffer = GLenum(integer(GL_DRAW_BUFFER))};
  gl.GetBooleanv(GL_COLOR_WRITEMASK, view.written.data());
  gl.GetIntegerv(GL_VIEWPORT, view.viewport.data());
  if (gl.IsEnabled(GL_SCISSOR_TEST)) gl.GetIntegerv(GL_SCISSOR_BOX, view.scissor.data());
  return view;
}

}  // namespace understudy::spu
