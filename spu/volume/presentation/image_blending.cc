// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/presentation/image_blending.h"

namespace understudy::spu {

void set_image_blending(const DispatchTable& gl, volume::Operator op) {
  gl.BlendEquation(op == volume::Operator::max ? GL_MAX : op == volume::Operator::min ? GL_MIN : GL_FUNC_ADD);
  gl.BlendFunc(GL_ONE, op == volume::Operator::over ? GL_ONE_MINUS_SRC_ALPHA : GL_ONE);
}

}  // namespace understudy::spu
