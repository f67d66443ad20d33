// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// What glGetIntegerv says of a state that is one number; 0 where OpenGL does not know it.
inline GLint state_value(const DispatchTable& gl, GLenum name) {
  GLint value = 0;
  gl.GetIntegerv(name, &value);
  return value;
}

}  // namespace understudy::spu
