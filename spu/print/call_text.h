// SPDX-License-Identifier: Apache-2.0
// A call as a person would write it:
//
//   glTexImage2D(target = GL_TEXTURE_2D, level = 0, ..., pixels = 4096 bytes)
//   glGenTextures(n = 1, textures = {7})
//   glGetError() = GL_NO_ERROR
#pragma once

#include <fmt/format.h>

#include <cstdint>

#include "dispatch/call_id.h"

namespace understudy::spu {

/// True when the call writes through a pointer or answers something that its text shows: then the text is made
/// after the call, otherwise before it, so that the last line of a crash names it.
bool shows_outcome(CallId call);

/// Pointer arguments that are only shown, and never followed: bit i for argument i.
using UnreadArguments = std::uint32_t;

/// What lies behind pointers is read only where it must be the application's memory; offsets into buffers are
/// not followed, nor are `unread` pointers. `result` is the result's word.
void append_call(fmt::memory_buffer& text, CallId call, const std::uint64_t* words, std::uint64_t result,
                 UnreadArguments unread = 0);

}  // namespace understudy::spu
