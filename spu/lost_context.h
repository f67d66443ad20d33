// SPDX-License-Identifier: Apache-2.0
// OpenGL of a context that is lost, where no driver is below that could go on with it.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

/// Functions that do nothing and answer zero. The first glGetError of each thread answers GL_OUT_OF_MEMORY.
/// Never throws, and needs no memory.
const DispatchTable& lost_context() noexcept;

}  // namespace understudy::spu
