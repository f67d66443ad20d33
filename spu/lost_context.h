// SPDX-License-Identifier: Apache-2.0
// OpenGL functions of a lost context, used if there is no driver below that could replace it.
#pragma once

#include <cstdint>

#include "dispatch/call_id.h"
#include "dispatch/table.h"

namespace understudy::spu {

/// The answer of a lost context to a call, with `words` as for invoke(): results of queries are available, sync
/// objects are signaled, and the context was reset, so that no application polls forever (OpenGL 4.5, section
/// 2.3.2). Returns the call's result, which is zero for all other calls; those write nothing.
std::uint64_t answer_of_lost_context(CallId call, const std::uint64_t* words) noexcept;

/// Functions that answer as above and do nothing else. The first glGetError of each thread returns
/// GL_OUT_OF_MEMORY. Never throws, and allocates no memory.
const DispatchTable& lost_context() noexcept;

}  // namespace understudy::spu
