// SPDX-License-Identifier: Apache-2.0
// OpenGL functions of a lost context, used if there is no driver below that could replace it.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// Functions that do nothing and return zero. The first glGetError of each thread returns GL_OUT_OF_MEMORY, and
/// graphics reset queries return GL_UNKNOWN_CONTEXT_RESET. Never throws, and allocates no memory.
const DispatchTable& lost_context() noexcept;

}  // namespace understudy::spu
