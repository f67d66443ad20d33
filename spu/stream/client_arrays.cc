// SPDX-License-Identifier: Apache-2.0
#include "spu/stream/client_arrays.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <string_view>

#include "spu/state_value.h"
#include "spu/stream/extent.h"

namespace understudy::spu {
namespace {

/// The names for querying a fixed-function array; 0 if there is no such query.
struct FixedArrayNames {
  ArrayRole role;
  GLenum array;
  GLenum size;
  GLint fixed_size;
  GLenum type;
  GLenum fixed_type;
  GLenum stride;
  GLenum buffer;
  GLenum pointer;
};

constexpr std::array<FixedArrayNames, 8> fixed_arrays = {{
    {ArrayRole::vertex, GL_VERTEX_ARRAY, GL_VERTEX_ARRAY_SIZE, 0, GL_VERTEX_ARRAY_TYPE, 0,
     GL_VERTEX_ARRAY_STRIDE, GL_VERTEX_ARRAY_BUFFER_BINDING, GL_VERTEX_ARRAY_POINTER},
    {ArrayRole::normal, GL_NORMAL_ARRAY, 0, 3, GL_NORMAL_ARRAY_TYPE, 0, GL_NORMAL_ARRAY_STRIDE,
     GL_NORMAL_ARRAY_BUFFER_BINDING, GL_NORMAL_ARRAY_POINTER},
    {ArrayRole::color, GL_COLOR_ARRAY, GL_COLOR_ARRAY_SIZE, 0, GL_COLOR_ARRAY_TYPE, 0, GL_COLOR_ARRAY_STRIDE,
     GL_COLOR_ARRAY_BUFFER_BINDING, GL_COLOR_ARRAY_POINTER},
    {ArrayRole::secondary_color, GL_SECONDARY_COLOR_ARRAY, GL_SECONDARY_COLOR_ARRAY_SIZE, 0,
     GL_SECONDARY_COLOR_ARRAY_TYPE, 0, GL_SECONDARY_COLOR_ARRAY_STRIDE, GL_SECONDARY_COLOR_ARRAY_BUFFER_BINDING,
     GL_SECONDARY_COLOR_ARRAY_POINTER},
    {ArrayRole::fog_coordinate, GL_FOG_COORD_ARRAY, 0, 1, GL_FOG_COORD_ARRAY_TYPE, 0, GL_FOG_COORD_ARRAY_STRIDE,
     GL_FOG_COORD_ARRAY_BUFFER_BINDING, GL_FOG_COORD_ARRAY_POINTER},
    {ArrayRole::index, GL_INDEX_ARRAY, 0, 1, GL_INDEX_ARRAY_TYPE, 0, GL_INDEX_ARRAY_STRIDE,
     GL_INDEX_ARRAY_BUFFER_BINDING, GL_INDEX_ARRAY_POINTER},
    {ArrayRole::edge_flag, GL_EDGE_FLAG_ARRAY, 0, 1, 0, GL_UNSIGNED_BYTE, GL_EDGE_FLAG_ARRAY_STRIDE,
     GL_EDGE_FLAG_ARRAY_BUFFER_BINDING, GL_EDGE_FLAG_ARRAY_POINTER},
    {ArrayRole::texture_coordinate, GL_TEXTURE_COORD_ARRAY, GL_TEXTURE_COORD_ARRAY_SIZE, 0,
     GL_TEXTURE_COORD_ARRAY_TYPE, 0, GL_TEXTURE_COORD_ARRAY_STRIDE, GL_TEXTURE_COORD_ARRAY_BUFFER_BINDING,
     GL_TEXTURE_COORD_ARRAY_POINTER},
}};

void add_fixed(const DispatchTable& gl, const FixedArrayNames& names, GLuint index,
               std::vector<ClientArray>& arrays) {
  if (!gl.IsEnabled(names.array) || state_value(gl, names.buffer) != 0) return;
  ClientArray array{.role = names.role, .index = index};
  array.size = names.size != 0 ? state_value(gl, names.size) : names.fixed_size;
  array.type = names.type != 0 ? GLenum(state_value(gl, names.type)) : names.fixed_type;
  array.stride = state_value(gl, names.stride);
  void* pointer = nullptr;
  gl.GetPointerv(names.pointer, &pointer);
  array.pointer = reinterpret_cast<std::uintptr_t>(pointer);
  arrays.push_back(array);
}

bool is_core(const DispatchTable& gl) {
  if (state_value(gl, GL_MAJOR_VERSION) < 3) return false;
  return (state_value(gl, GL_CONTEXT_PROFILE_MASK) & GL_CONTEXT_CORE_PROFILE_BIT) != 0;
}

void add_all_fixed(const DispatchTable& gl, std::vector<ClientArray>& arrays) {
  const GLint active = state_value(gl, GL_CLIENT_ACTIVE_TEXTURE);
  for (const FixedArrayNames& names : fixed_arrays) {
    if (names.role != ArrayRole::texture_coordinate) {
      add_fixed(gl, names, 0, arrays);
      continue;
    }
    const GLint units = state_value(gl, GL_MAX_TEXTURE_COORDS);
    for (GLint unit = 0; unit < units; ++unit) {
      gl.ClientActiveTexture(GLenum(GL_TEXTURE0 + unit));
      add_fixed(gl, names, GLuint(unit), arrays);
    }
    gl.ClientActiveTexture(GLenum(active));
  }
}

GLint attribute(const DispatchTable& gl, GLuint index, GLenum name) {
  GLint value = 0;
  gl.GetVertexAttribiv(index, name, &value);
  return value;
}

void add_generic(const DispatchTable& gl, GLuint index, std::vector<ClientArray>& arrays) {
  if (attribute(gl, index, GL_VERTEX_ATTRIB_ARRAY_ENABLED) == 0 ||
      attribute(gl, index, GL_VERTEX_ATTRIB_ARRAY_BUFFER_BINDING) != 0) {
    return;
  }
  ClientArray array{.role = ArrayRole::generic, .index = index};
  array.size = attribute(gl, index, GL_VERTEX_ATTRIB_ARRAY_SIZE);
  array.type = GLenum(attribute(gl, index, GL_VERTEX_ATTRIB_ARRAY_TYPE));
  array.normalized = attribute(gl, index, GL_VERTEX_ATTRIB_ARRAY_NORMALIZED) != 0;
  array.stride = attribute(gl, index, GL_VERTEX_ATTRIB_ARRAY_STRIDE);
  if (attribute(gl, index, GL_VERTEX_ATTRIB_ARRAY_INTEGER) != 0) array.role = ArrayRole::generic_integer;
  if (gl.VertexAttribLPointer != nullptr && array.type == GL_DOUBLE &&
      attribute(gl, index, GL_VERTEX_ATTRIB_ARRAY_LONG) != 0) {
    array.role = ArrayRole::generic_double;
  }
  if (gl.VertexAttribDivisor != nullptr)
    array.divisor = GLuint(attribute(gl, index, GL_VERTEX_ATTRIB_ARRAY_DIVISOR));
  void* pointer = nullptr;
  gl.GetVertexAttribPointerv(index, GL_VERTEX_ATTRIB_ARRAY_POINTER, &pointer);
  array.pointer = reinterpret_cast<std::uintptr_t>(pointer);
  arrays.push_back(array);
}

/// Positions of a draw's arguments, found by their names in the registry.
struct DrawArguments {
  std::uint8_t first = no_argument;
  std::uint8_t count = no_argument;
  std::uint8_t type = no_argument;
  std::uint8_t indices = no_argument;
  std::uint8_t instances = no_argument;
  std::uint8_t base_vertex = no_argument;
  std::uint8_t base_instance = no_argument;
  std::uint8_t draws = no_argument;
  std::uint8_t element = no_argument;
  bool draw = false;
};

DrawArguments describe_draw(CallId call) {
  const std::string_view name = call_name(call);
  DrawArguments arguments;
  const bool multi = name.starts_with("glMultiDraw");
  const bool element = name == "glArrayElement" || name == "glArrayElementEXT";
  arguments.draw = element || multi || name.starts_with("glDrawArrays") || name.starts_with("glDrawElements") ||
                   name.starts_with("glDrawRangeElements");
  if (!arguments.draw) return arguments;
  std::uint8_t position = 0;
  for (const ParameterShape& parameter : call_shape(call).parameters()) {
    const std::string_view is = parameter.name();
    if (is == "first") arguments.first = position;
    if (is == "count") arguments.count = position;
    if (is == "type") arguments.type = position;
    if (is == "indices") arguments.indices = position;
    if (is == "instancecount" || (is == "primcount" && !multi)) arguments.instances = position;
    if (is == "basevertex") arguments.base_vertex = position;
    if (is == "baseinstance") arguments.base_instance = position;
    if (is == "drawcount" || (is == "primcount" && multi)) arguments.draws = position;
    if (is == "i" && element) arguments.element = position;
    ++position;
  }
  return arguments;
}

const DrawArguments& draw_arguments(CallId call) {
  static const std::vector<DrawArguments> all = [] {
    std::vector<DrawArguments> table(call_count);
    for (std::size_t i = 0; i < call_count; ++i) table[i] = describe_draw(CallId(i));
    return table;
  }();
  return all[std::size_t(call)];
}

void include(ElementRange& range, std::int64_t first, std::int64_t last) {
  if (last < first) return;
  if (range.empty()) {
    range.first = first;
    range.last = last;
  } else {
    range.first = std::min(range.first, first);
    range.last = std::max(range.last, last);
  }
}

/// The index that starts a new primitive and does not refer to a vertex.
std::optional<std::uint32_t> restart_index(const DispatchTable& gl, std::size_t index_size) {
  // NV_primitive_restart is older, has its own names and is client state.
  if (gl.PrimitiveRestartIndexNV != nullptr && gl.IsEnabled(GL_PRIMITIVE_RESTART_NV))
    return std::uint32_t(state_value(gl, GL_PRIMITIVE_RESTART_INDEX_NV));
  if (gl.PrimitiveRestartIndex == nullptr) return std::nullopt;
  if (gl.IsEnabled(GL_PRIMITIVE_RESTART_FIXED_INDEX))
    return std::uint32_t(std::numeric_limits<std::uint32_t>::max() >> (32 - 8 * index_size));
  if (gl.IsEnabled(GL_PRIMITIVE_RESTART)) return std::uint32_t(state_value(gl, GL_PRIMITIVE_RESTART_INDEX));
  return std::nullopt;
}

bool include_indices(const DispatchTable& gl, ElementRange& range, std::int64_t count, GLenum type,
                     std::uint64_t indices, std::int64_t base_vertex) {
  const std::size_t size = component_size(type);
  if (count <= 0) return true;
  if (size == 0 || size > 4) return false;
  std::vector<std::byte> copy;
  const auto* bytes = reinterpret_cast<const std::byte*>(static_cast<std::uintptr_t>(indices));
  if (state_value(gl, GL_ELEMENT_ARRAY_BUFFER_BINDING) != 0) {
    GLint available = 0;
    gl.GetBufferParameteriv(GL_ELEMENT_ARRAY_BUFFER, GL_BUFFER_SIZE, &available);
    const auto wanted = std::uint64_t(count) * size;
    if (indices > std::uint64_t(available) || wanted > std::uint64_t(available) - indices) return false;
    copy.resize(wanted);
    gl.GetBufferSubData(GL_ELEMENT_ARRAY_BUFFER, GLintptr(indices), GLsizeiptr(wanted), copy.data());
    bytes = copy.data();
  }
  if (bytes == nullptr) return false;
  const auto restart = restart_index(gl, size);
  for (std::int64_t i = 0; i < count; ++i) {
    std::uint32_t index = 0;
    std::memcpy(&index, bytes + std::size_t(i) * size, size);  // little-endian
    if (restart && index == *restart) continue;
    include(range, index + base_vertex, index + base_vertex);
  }
  return true;
}

}  // namespace

std::size_t ClientArray::element_bytes() const {
  // Packed types hold four components in one value.
  if (type == GL_INT_2_10_10_10_REV || type == GL_UNSIGNED_INT_2_10_10_10_REV ||
      type == GL_UNSIGNED_INT_10F_11F_11F_REV) {
    return 4;
  }
  return component_size(type) * std::size_t(size == GL_BGRA ? 4 : std::clamp(size, 0, 4));
}

std::vector<ClientArray> client_arrays(const DispatchTable& gl) {
  return gl.GetString == nullptr || is_core(gl) ? std::vector<ClientArray>() : arrays_without_buffer(gl);
}

std::vector<ClientArray> arrays_without_buffer(const DispatchTable& gl) {
  std::vector<ClientArray> arrays;
  if (!is_core(gl)) add_all_fixed(gl, arrays);
  const GLint attributes = state_value(gl, GL_MAX_VERTEX_ATTRIBS);
  for (GLint i = 0; i < attributes; ++i) add_generic(gl, GLuint(i), arrays);
  return arrays;
}

void point_array(const DispatchTable& gl, const ClientArray& array, GLsizei stride, const void* pointer) {
  switch (array.role) {
    case ArrayRole::vertex:
      gl.VertexPointer(array.size, array.type, stride, pointer);
      break;
    case ArrayRole::normal:
      gl.NormalPointer(array.type, stride, pointer);
      break;
    case ArrayRole::color:
      gl.ColorPointer(array.size, array.type, stride, pointer);
      break;
    case ArrayRole::secondary_color:
      gl.SecondaryColorPointer(array.size, array.type, stride, pointer);
      break;
    case ArrayRole::fog_coordinate:
      gl.FogCoordPointer(array.type, stride, pointer);
      break;
    case ArrayRole::index:
      gl.IndexPointer(array.type, stride, pointer);
      break;
    case ArrayRole::edge_flag:
      gl.EdgeFlagPointer(stride, pointer);
      break;
    case ArrayRole::texture_coordinate: {
      const GLint active = state_value(gl, GL_CLIENT_ACTIVE_TEXTURE);
      gl.ClientActiveTexture(GL_TEXTURE0 + array.index);
      gl.TexCoordPointer(array.size, array.type, stride, pointer);
      gl.ClientActiveTexture(GLenum(active));
      break;
    }
    case ArrayRole::generic:
      gl.VertexAttribPointer(array.index, array.size, array.type, GLboolean(array.normalized), stride, pointer);
      break;
    case ArrayRole::generic_integer:
      gl.VertexAttribIPointer(array.index, array.size, array.type, stride, pointer);
      break;
    case ArrayRole::generic_double:
      gl.VertexAttribLPointer(array.index, array.size, array.type, stride, pointer);
      break;
  }
}

std::uint64_t pointer_of(const DispatchTable& gl, const ClientArray& array) {
  void* pointer = nullptr;
  const auto fixed = std::find_if(fixed_arrays.begin(), fixed_arrays.end(),
                                  [&](const FixedArrayNames& names) { return names.role == array.role; });
  if (fixed == fixed_arrays.end()) {
    gl.GetVertexAttribPointerv(array.index, GL_VERTEX_ATTRIB_ARRAY_POINTER, &pointer);
  } else if (array.role != ArrayRole::texture_coordinate) {
    gl.GetPointerv(fixed->pointer, &pointer);
  } else {
    const GLint active = state_value(gl, GL_CLIENT_ACTIVE_TEXTURE);
    gl.ClientActiveTexture(GL_TEXTURE0 + array.index);
    gl.GetPointerv(fixed->pointer, &pointer);
    gl.ClientActiveTexture(GLenum(active));
  }
  return reinterpret_cast<std::uintptr_t>(pointer);
}

bool draws_arrays(CallId call) noexcept {
  return draw_arguments(call).draw;
}

std::optional<ElementRange> element_range(const DispatchTable& gl, CallId call, const std::uint64_t* words) {
  const DrawArguments& at = draw_arguments(call);
  const auto value = [&](std::uint8_t argument, std::int64_t otherwise) {
    return argument == no_argument ? otherwise : std::int64_t(std::int32_t(words[argument]));
  };
  ElementRange range;
  range.first_instance = value(at.base_instance, 0);
  range.last_instance = range.first_instance + std::max<std::int64_t>(value(at.instances, 1), 1) - 1;
  if (at.element != no_argument) {
    include(range, value(at.element, 0), value(at.element, 0));
    return range;
  }
  if (at.count == no_argument) return std::nullopt;
  if (at.draws == no_argument) {
    if (at.indices == no_argument) {
      include(range, value(at.first, 0), value(at.first, 0) + value(at.count, 0) - 1);
      return range;
    }
    const bool known = include_indices(gl, range, value(at.count, 0), GLenum(words[at.type]), words[at.indices],
                                       value(at.base_vertex, 0));
    return known ? std::optional(range) : std::nullopt;
  }
  const auto array_of = [&](std::uint8_t argument) {
    return reinterpret_cast<const GLint*>(static_cast<std::uintptr_t>(words[argument]));
  };
  const GLint* counts = array_of(at.count);
  for (std::int64_t draw = 0; draw < value(at.draws, 0); ++draw) {
    if (at.indices == no_argument) {
      const std::int64_t first = array_of(at.first)[draw];
      include(range, first, first + counts[draw] - 1);
      continue;
    }
    const auto* lists = reinterpret_cast<const std::uint64_t*>(static_cast<std::uintptr_t>(words[at.indices]));
    const std::int64_t base = at.base_vertex != no_argument ? array_of(at.base_vertex)[draw] : 0;
    if (!include_indices(gl, range, counts[draw], GLenum(words[at.type]), lists[draw], base))
      return std::nullopt;
  }
  return range;
}

}  // namespace understudy::spu
