// SPDX-License-Identifier: Apache-2.0
#include "tests/adversary/blending.h"

namespace adversary {

void set_blending(const Gl& gl, Blending blending) {
  if (blending == Blending::off) return gl.Disable(GL_BLEND);
  gl.Enable(GL_BLEND);
  gl.BlendEquation(blending == Blending::maximum   ? GL_MAX
                   : blending == Blending::minimum ? GL_MIN
                                                   : GL_FUNC_ADD);
  switch (blending) {
    case Blending::over:
      return gl.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    case Blending::premultiplied_over:
      return gl.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    case Blending::under:
      return gl.BlendFunc(GL_ONE_MINUS_DST_ALPHA, GL_ONE);
    default:
      return gl.BlendFunc(GL_ONE, GL_ONE);
  }
}

}  // namespace adversary
