// SPDX-License-Identifier: Apache-2.0
// The buffer objects that pointer arguments are offsets into while they are bound.
#pragma once

#include <cstdint>
#include <optional>

#include "dispatch/call_shape.h"
#include "dispatch/table.h"

namespace understudy::spu {

struct BufferPoint {
  GLenum target;   ///< for glBindBuffer
  GLenum binding;  ///< for glGetIntegerv
};

/// Nothing for rules under which a pointer is always memory.
std::optional<BufferPoint> buffer_point(ExtentRule rule) noexcept;

/// GL_ARRAY_BUFFER_BINDING for GL_ARRAY_BUFFER; GL_NONE for what is no target.
GLenum binding_of_target(GLenum target) noexcept;

/// The integer that OpenGL answers; nothing where it answers no question, as between glBegin and glEnd. The
/// question then raises the error that any call but those of vertices would raise there.
std::optional<GLint> asked(const DispatchTable& gl, GLenum name);

/// Bytes of the buffer object that is bound to `target`.
std::uint64_t bound_bytes(const DispatchTable& gl, GLenum target);

}  // namespace understudy::spu
