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

/// True if the text shows memory that the call writes or a result. The text is then made after the call,
/// otherwise before it, so that after a crash the last line names the call that crashed.
bool shows_outcome(CallId call);

/// Pointer arguments that are printed but never dereferenced: bit i for argument i.
using UnreadArguments = std::uint32_t;

/// Appends the text of a call; `result` is the result's word. Memory behind a pointer is read only if it must
/// be the application's: offsets into buffers and `unread` pointers are not dereferenced.
void append_call(fmt::memory_buffer& text, CallId call, const std::uint64_t* words, std::uint64_t result,
                 UnreadArguments unread = 0);

}  // namespace understudy::spu
