// SPDX-License-Identifier: Apache-2.0
// The buffer bindings that turn pointer arguments into offsets.
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

/// Nothing for rules whose pointers always refer to memory.
std::optional<BufferPoint> buffer_point(ExtentRule rule) noexcept;

/// GL_ARRAY_BUFFER_BINDING for GL_ARRAY_BUFFER; GL_NONE if `target` is not a target.
GLenum binding_of_target(GLenum target) noexcept;

/// Returns glGetIntegerv's value, or nothing if OpenGL does not answer, as between glBegin and glEnd. The query
/// then raises the error that any call except vertex calls would raise there.
std::optional<GLint> asked(const DispatchTable& gl, GLenum name);

/// Size in bytes of the buffer object that is bound to `target`.
std::uint64_t bound_bytes(const DispatchTable& gl, GLenum target);

}  // namespace understudy::spu
