// SPDX-License-Identifier: Apache-2.0
// Vertex arrays in the application's memory: the elements that a draw reads must be sent with the draw, because
// the application may change them as soon as the call has returned.
//
// In a stream, such a draw is enclosed by two events: `arrays` points OpenGL at copies, `arrays_end` restores
// the application's pointers. The draw's own arguments are unchanged.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "dispatch/call_shape.h"
#include "dispatch/table.h"

namespace understudy::spu {

enum class ArrayRole : std::uint32_t {
  vertex,
  normal,
  color,
  secondary_color,
  fog_coordinate,
  index,
  edge_flag,
  texture_coordinate,
  generic,
  generic_integer,
  generic_double,
};
constexpr std::uint32_t array_role_count = 11;

/// An enabled array that is not in a buffer object.
struct ClientArray {
  ArrayRole role = ArrayRole::vertex;
  GLuint index = 0;  ///< texture unit or attribute
  GLint size = 4;    ///< components, or GL_BGRA
  GLenum type = GL_FLOAT;
  bool normalized = false;
  GLsizei stride = 0;  ///< as the application specified it: 0 for tightly packed
  std::uint64_t pointer = 0;
  GLuint divisor = 0;  ///< 0: one element per vertex, else one element for that many instances

  /// Bytes of one element; 0 if the type is unknown.
  std::size_t element_bytes() const;
  std::size_t step() const { return stride != 0 ? std::size_t(stride) : element_bytes(); }
};

/// The arrays that a draw would read from client memory now. Must not be called between glBegin and glEnd.
std::vector<ClientArray> client_arrays(const DispatchTable& gl);
/// Every enabled array without a buffer object. Draws of a core profile must not read one, but a driver may not
/// check that.
std::vector<ClientArray> arrays_without_buffer(const DispatchTable& gl);

/// Sets address and stride of an array. No buffer may be bound to GL_ARRAY_BUFFER.
void point_array(const DispatchTable& gl, const ClientArray& array, GLsizei stride, const void* pointer);

/// The address of the array with this role and index, queried from OpenGL.
std::uint64_t pointer_of(const DispatchTable& gl, const ClientArray& array);

/// The elements that a draw reads, first and last included.
struct ElementRange {
  std::int64_t first = 0;
  std::int64_t last = -1;
  std::int64_t first_instance = 0;
  std::int64_t last_instance = 0;

  bool empty() const { return last < first; }
};

/// Whether the call reads vertex arrays.
bool draws_arrays(CallId call) noexcept;

/// The elements that the call would read; nothing if that cannot be determined. `words` as for invoke(); index
/// and parameter buffers are read through `gl`.
std::optional<ElementRange> element_range(const DispatchTable& gl, CallId call, const std::uint64_t* words);

}  // namespace understudy::spu
