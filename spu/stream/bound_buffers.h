// SPDX-License-Identifier: Apache-2.0
// The buffer bindings that turn pointer arguments into offsets.
#pragma once

#include <cstdint>
#include <optional>

#include "dispatch/call_id.h"
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
/// GL_ARRAY_BUFFER for GL_ARRAY_BUFFER_BINDING; GL_NONE if `binding` is not a binding.
GLenum target_of_binding(GLenum binding) noexcept;

/// Returns glGetIntegerv's value, or nothing if OpenGL does not answer, as between glBegin and glEnd. The query
/// then raises the error that any call except vertex calls would raise there.
std::optional<GLint> asked(const DispatchTable& gl, GLenum name);

/// The buffer object that a call refers to by its first argument, a name or a target; 0 if there is none.
GLuint buffer_of(const DispatchTable& gl, CallId call, const std::uint64_t* words);

/// Where OpenGL has mapped a buffer.
struct BufferMapping {
  void* first = nullptr;  ///< null: it is not mapped, or does not exist
  GLint access = GL_READ_ONLY;
};
/// Mappings can end in other contexts, so the driver is queried. Not between glBegin and glEnd.
BufferMapping mapping_of(const DispatchTable& gl, GLuint buffer);

/// Size in bytes of the buffer object that is bound to `target`.
std::uint64_t bound_bytes(const DispatchTable& gl, GLenum target);

}  // namespace understudy::spu
