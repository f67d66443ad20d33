// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/observation/client_arrays.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "spu/stream/plain_calls.h"
#include "spu/volume/context/context.h"

namespace understudy::spu {
namespace {

std::size_t size_of(GLenum type) {
  switch (type) {
    case GL_BYTE:
    case GL_UNSIGNED_BYTE:
      return 1;
    case GL_SHORT:
    case GL_UNSIGNED_SHORT:
      return 2;
    case GL_INT:
    case GL_UNSIGNED_INT:
    case GL_FLOAT:
      return 4;
    case GL_DOUBLE:
      return 8;
    default:
      return 0;
  }
}

template <class T>
T load(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

/// Converts a component as OpenGL does; normalised integers map to [0,1] or [-1,1] (OpenGL 4.6, 2.3.5).
float component(const std::byte* from, GLenum type, bool normalised) {
  switch (type) {
    case GL_BYTE:
      return normalised ? std::max(float(load<std::int8_t>(from)) / 127.0F, -1.0F)
                        : float(load<std::int8_t>(from));
    case GL_UNSIGNED_BYTE:
      return normalised ? float(load<std::uint8_t>(from)) / 255.0F : float(load<std::uint8_t>(from));
    case GL_SHORT:
      return normalised ? std::max(float(load<std::int16_t>(from)) / 32767.0F, -1.0F)
                        : float(load<std::int16_t>(from));
    case GL_UNSIGNED_SHORT:
      return normalised ? float(load<std::uint16_t>(from)) / 65535.0F : float(load<std::uint16_t>(from));
    case GL_INT:
      return normalised ? float(double(load<std::int32_t>(from)) / 2147483647.0)
                        : float(load<std::int32_t>(from));
    case GL_UNSIGNED_INT:
      return normalised ? float(double(load<std::uint32_t>(from)) / 4294967295.0)
                        : float(load<std::uint32_t>(from));
    case GL_DOUBLE:
      return float(load<double>(from));
    default:
      return load<float>(from);
  }
}

struct FixedPointerNames {
  GLenum enable, size, type, stride, buffer, pointer;
};

bool add_fixed(const DispatchTable& gl, ArraySources& sources, int& in_buffers, MemoryArray array,
               const FixedPointerNames& names) {
  if (!gl.IsEnabled(names.enable)) return true;
  GLint value = 0;
  if (names.size != 0) gl.GetIntegerv(names.size, &array.components);
  gl.GetIntegerv(names.type, &value);
  array.type = GLenum(value);
  gl.GetIntegerv(names.stride, &value);
  const std::size_t size = size_of(array.type);
  array.stride = value != 0 ? std::size_t(value) : size * std::size_t(array.components);
  GLint buffer = 0;
  gl.GetIntegerv(names.buffer, &buffer);
  void* pointer = nullptr;
  gl.GetPointerv(names.pointer, &pointer);
  array.first = static_cast<const std::byte*>(pointer);
  if (buffer != 0) {
    ++in_buffers;
  } else {
    sources.client_memory = true;
    sources.arrays.push_back(array);
  }
  return size != 0 && array.components >= 1 && array.components <= 4;
}

/// Returns whether the attribute is not a float, or is not read once per vertex.
bool is_uncommon(const GlContext& context, GLuint index) {
  const auto asked = [&](GLenum name) {
    GLint value = 0;
    context.gl->GetVertexAttribiv(index, name, &value);
    return value != 0;
  };
  return asked(GL_VERTEX_ATTRIB_ARRAY_INTEGER) ||
         ((context.version >= 330 || has_extension(context, "GL_ARB_instanced_arrays")) &&
          asked(GL_VERTEX_ATTRIB_ARRAY_DIVISOR)) ||
         (context.version >= 410 && asked(GL_VERTEX_ATTRIB_ARRAY_LONG));
}

/// Adds the enabled generic attribute `index`. Returns false if it is not supported.
bool add_generic(const GlContext& context, ArraySources& sources, int& in_buffers, GLuint index) {
  const DispatchTable& gl = *context.gl;
  MemoryArray array{.role = MemoryArray::Role::generic, .index = GLint(index)};
  GLint buffer = 0;
  GLint value = 0;
  gl.GetVertexAttribiv(index, GL_VERTEX_ATTRIB_ARRAY_BUFFER_BINDING, &buffer);
  if (buffer != 0) {
    ++in_buffers;
    return true;
  }
  if (is_uncommon(context, index)) return false;
  gl.GetVertexAttribiv(index, GL_VERTEX_ATTRIB_ARRAY_SIZE, &array.components);
  gl.GetVertexAttribiv(index, GL_VERTEX_ATTRIB_ARRAY_TYPE, &value);
  array.type = GLenum(value);
  gl.GetVertexAttribiv(index, GL_VERTEX_ATTRIB_ARRAY_NORMALIZED, &value);
  array.normalised = value != 0;
  gl.GetVertexAttribiv(index, GL_VERTEX_ATTRIB_ARRAY_STRIDE, &value);
  const std::size_t size = size_of(array.type);
  array.stride = value != 0 ? std::size_t(value) : size * std::size_t(array.components);
  void* pointer = nullptr;
  gl.GetVertexAttribPointerv(index, GL_VERTEX_ATTRIB_ARRAY_POINTER, &pointer);
  array.first = static_cast<const std::byte*>(pointer);
  sources.client_memory = true;
  sources.arrays.push_back(array);
  return size != 0 && array.components >= 1 && array.components <= 4;
}

}  // namespace

std::optional<std::string> read_array_sources(const GlContext& context, ArraySources& sources) {
  const DispatchTable& gl = *context.gl;
  int in_buffers = 0;
  bool understood = true;
  using Role = MemoryArray::Role;
  if (!context.core) {
    GLint client_active = GL_TEXTURE0;
    gl.GetIntegerv(GL_CLIENT_ACTIVE_TEXTURE, &client_active);
    for (int unit = 0; unit < context.fixed_function_units; ++unit) {
      gl.ClientActiveTexture(GLenum(GL_TEXTURE0 + unit));
      understood &= add_fixed(gl, sources, in_buffers, {.role = Role::texture_coordinate, .index = unit},
                              {GL_TEXTURE_COORD_ARRAY, GL_TEXTURE_COORD_ARRAY_SIZE, GL_TEXTURE_COORD_ARRAY_TYPE,
                               GL_TEXTURE_COORD_ARRAY_STRIDE, GL_TEXTURE_COORD_ARRAY_BUFFER_BINDING,
                               GL_TEXTURE_COORD_ARRAY_POINTER});
    }
    gl.ClientActiveTexture(GLenum(client_active));
    understood &=
        add_fixed(gl, sources, in_buffers, {.role = Role::normal, .components = 3, .normalised = true},
                  {GL_NORMAL_ARRAY, 0, GL_NORMAL_ARRAY_TYPE, GL_NORMAL_ARRAY_STRIDE,
                   GL_NORMAL_ARRAY_BUFFER_BINDING, GL_NORMAL_ARRAY_POINTER});
    understood &= add_fixed(gl, sources, in_buffers, {.role = Role::colour, .normalised = true},
                            {GL_COLOR_ARRAY, GL_COLOR_ARRAY_SIZE, GL_COLOR_ARRAY_TYPE, GL_COLOR_ARRAY_STRIDE,
                             GL_COLOR_ARRAY_BUFFER_BINDING, GL_COLOR_ARRAY_POINTER});
    if (gl.IsEnabled(GL_SECONDARY_COLOR_ARRAY) || gl.IsEnabled(GL_FOG_COORD_ARRAY) ||
        gl.IsEnabled(GL_EDGE_FLAG_ARRAY) || gl.IsEnabled(GL_INDEX_ARRAY)) {
      return "vertex arrays of secondary colour, fog or edge flags";
    }
  }
  GLint attributes = 0;
  gl.GetIntegerv(GL_MAX_VERTEX_ATTRIBS, &attributes);
  // Attribute 0 completes the vertex, so it comes last.
  for (GLint i = attributes - 1; i >= 0; --i) {
    GLint enabled = 0;
    gl.GetVertexAttribiv(GLuint(i), GL_VERTEX_ATTRIB_ARRAY_ENABLED, &enabled);
    if (enabled) understood &= add_generic(context, sources, in_buffers, GLuint(i));
  }
  if (!context.core) {
    understood &= add_fixed(gl, sources, in_buffers, {.role = Role::vertex},
                            {GL_VERTEX_ARRAY, GL_VERTEX_ARRAY_SIZE, GL_VERTEX_ARRAY_TYPE,
                             GL_VERTEX_ARRAY_STRIDE, GL_VERTEX_ARRAY_BUFFER_BINDING, GL_VERTEX_ARRAY_POINTER});
  }
  if (!understood) return "vertex arrays of an uncommon type";
  if (sources.client_memory && in_buffers > 0) return "vertex arrays partly in buffers, partly in memory";
  return std::nullopt;
}

bool restarts_primitives(const GlContext& context) {
  const DispatchTable& gl = *context.gl;
  return (context.version >= 430 && gl.IsEnabled(GL_PRIMITIVE_RESTART_FIXED_INDEX)) ||
         (context.version >= 310 && gl.IsEnabled(GL_PRIMITIVE_RESTART)) ||
         (has_extension(context, "GL_NV_primitive_restart") && gl.IsEnabled(GL_PRIMITIVE_RESTART_NV));
}

void append_elements(Records& calls, const ArraySources& sources, GLenum mode,
                     const std::vector<std::uint32_t>& indices) {
  using Role = MemoryArray::Role;
  // Generic attributes alone draw too, but only attribute 0 or the position completes an immediate vertex.
  const bool positioned =
      std::any_of(sources.arrays.begin(), sources.arrays.end(), [](const MemoryArray& array) {
        return array.role == Role::vertex || (array.role == Role::generic && array.index == 0);
      });
  append_call(calls, &DispatchTable::Begin, mode);
  for (const std::uint32_t element : indices) {
    for (const MemoryArray& array : sources.arrays) {
      if (array.first == nullptr) continue;
      std::array<float, 4> v{0, 0, 0, 1};
      const std::byte* from = array.first + array.stride * element;
      for (int c = 0; c < array.components; ++c) {
        v[std::size_t(c)] =
            component(from + std::size_t(c) * size_of(array.type), array.type, array.normalised);
      }
      switch (array.role) {
        case Role::texture_coordinate:
          append_call(calls, &DispatchTable::MultiTexCoord4f, GLenum(GL_TEXTURE0 + array.index), v[0], v[1],
                      v[2], v[3]);
          break;
        case Role::normal:
          append_call(calls, &DispatchTable::Normal3f, v[0], v[1], v[2]);
          break;
        case Role::colour:
          append_call(calls, &DispatchTable::Color4f, v[0], v[1], v[2], v[3]);
          break;
        case Role::generic:
          append_call(calls, &DispatchTable::VertexAttrib4f, GLuint(array.index), v[0], v[1], v[2], v[3]);
          break;
        case Role::vertex:
          append_call(calls, &DispatchTable::Vertex4f, v[0], v[1], v[2], v[3]);
          break;
      }
    }
    if (!positioned) append_call(calls, &DispatchTable::Vertex4f, 0, 0, 0, 1);
  }
  append_call(calls, &DispatchTable::End);
}

}  // namespace understudy::spu
