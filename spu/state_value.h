// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// Returns glGetIntegerv's value of a scalar state; 0 if OpenGL does not know the state.
inline GLint state_value(const DispatchTable& gl, GLenum name) {
  GLint value = 0;
  gl.GetIntegerv(name, &value);
  return value;
}

}  // namespace understudy::spu
