// SPDX-License-Identifier: Apache-2.0
#include "spu/volume/observation/array_calls.h"

#include <algorithm>
#include <array>

#include "spu/volume/observation/draw_observer.h"

namespace understudy::spu {
namespace {

/// Returns the table below; closes the run first if it still needs the arrays as they are.
const DispatchTable& before_change() {
  DrawObserver& observer = DrawObserver::current();
  if (observer.run_open() && (observer.run().reads_arrays || observer.run().inside_begin)) observer.close_run();
  return observer.next();
}

/// State of arrays, and constants, outside of the ranges in is_about_arrays().
constexpr std::array<GLenum, 17> of_arrays{GL_ARRAY_BUFFER_BINDING,
                                           GL_ELEMENT_ARRAY_BUFFER_BINDING,
                                           GL_DRAW_INDIRECT_BUFFER_BINDING,
                                           GL_CLIENT_ACTIVE_TEXTURE,
                                           GL_PIXEL_UNPACK_BUFFER_BINDING,
                                           GL_PIXEL_PACK_BUFFER_BINDING,
                                           GL_MAJOR_VERSION,
                                           GL_MINOR_VERSION,
                                           GL_CONTEXT_PROFILE_MASK,
                                           GL_MAX_TEXTURE_COORDS,
                                           GL_MAX_VERTEX_ATTRIBS,
                                           GL_PRIMITIVE_RESTART,
                                           GL_PRIMITIVE_RESTART_FIXED_INDEX,
                                           GL_PRIMITIVE_RESTART_INDEX,
                                           GL_FOG_COORD_ARRAY_BUFFER_BINDING,
                                           GL_FOG_COORD_ARRAY,
                                           GL_SECONDARY_COLOR_ARRAY};

/// Returns whether no call in a run changes this state.
bool is_about_arrays(GLenum name) {
  // The enumerants of fixed arrays are consecutive: enables, sizes, types, strides, pointers; bindings.
  return std::ranges::find(of_arrays, name) != of_arrays.end() ||
         (name >= GL_VERTEX_ARRAY && name <= GL_EDGE_FLAG_ARRAY_POINTER) ||
         (name >= GL_FOG_COORD_ARRAY_TYPE && name <= GL_FOG_COORD_ARRAY) ||
         (name >= GL_SECONDARY_COLOR_ARRAY_SIZE && name <= GL_SECONDARY_COLOR_ARRAY) ||
         (name >= GL_VERTEX_ARRAY_BUFFER_BINDING && name <= GL_VERTEX_ATTRIB_ARRAY_BUFFER_BINDING);
}

/// Returns the table below; closes the run first unless the query is about arrays.
const DispatchTable& before_question(GLenum name) {
  DrawObserver& observer = DrawObserver::current();
  if (observer.run_open() && (!is_about_arrays(name) || observer.run().inside_begin)) observer.close_run();
  return observer.next();
}

void APIENTRY get_integer(GLenum name, GLint* value) {
  before_question(name).GetIntegerv(name, value);
}
void APIENTRY get_pointer(GLenum name, void** value) {
  before_question(name).GetPointerv(name, value);
}
GLboolean APIENTRY is_enabled_after_slices(GLenum name) {
  return before_question(name).IsEnabled(name);
}
void APIENTRY get_attribute(GLuint index, GLenum name, GLint* value) {
  // Slices change the current value.
  before_question(name == GL_CURRENT_VERTEX_ATTRIB ? name : GL_VERTEX_ARRAY)
      .GetVertexAttribiv(index, name, value);
}
void APIENTRY get_attribute_pointer(GLuint index, GLenum name, void** value) {
  before_question(GL_VERTEX_ARRAY).GetVertexAttribPointerv(index, name, value);
}
// The buffer size limits what a draw may read; runs do not change it.
void APIENTRY get_buffer(GLenum target, GLenum name, GLint* value) {
  before_question(GL_ARRAY_BUFFER_BINDING).GetBufferParameteriv(target, name, value);
}
void APIENTRY get_buffer_64(GLenum target, GLenum name, GLint64* value) {
  before_question(GL_ARRAY_BUFFER_BINDING).GetBufferParameteri64v(target, name, value);
}

void APIENTRY bind_buffer(GLenum target, GLuint buffer) {
  DrawObserver& observer = DrawObserver::current();
  if (target == GL_ARRAY_BUFFER || target == GL_ELEMENT_ARRAY_BUFFER) {
    before_change().BindBuffer(target, buffer);
  } else {
    observer.close_run();
    observer.next().BindBuffer(target, buffer);
  }
}
void APIENTRY client_active_texture(GLenum texture) {
  before_change().ClientActiveTexture(texture);
}
void APIENTRY vertex_pointer(GLint size, GLenum type, GLsizei stride, const void* pointer) {
  before_change().VertexPointer(size, type, stride, pointer);
}
void APIENTRY normal_pointer(GLenum type, GLsizei stride, const void* pointer) {
  before_change().NormalPointer(type, stride, pointer);
}
void APIENTRY color_pointer(GLint size, GLenum type, GLsizei stride, const void* pointer) {
  before_change().ColorPointer(size, type, stride, pointer);
}
void APIENTRY texture_coordinate_pointer(GLint size, GLenum type, GLsizei stride, const void* pointer) {
  before_change().TexCoordPointer(size, type, stride, pointer);
}
void APIENTRY attribute_pointer(GLuint index, GLint size, GLenum type, GLboolean normalized, GLsizei stride,
                                const void* pointer) {
  before_change().VertexAttribPointer(index, size, type, normalized, stride, pointer);
}

}  // namespace

void fill_array_calls(DispatchTable& table) {
  table.GetIntegerv = get_integer;
  table.GetPointerv = get_pointer;
  table.IsEnabled = is_enabled_after_slices;
  table.GetVertexAttribiv = get_attribute;
  table.GetVertexAttribPointerv = get_attribute_pointer;
  if (table.GetBufferParameteriv != nullptr) table.GetBufferParameteriv = get_buffer;
  if (table.GetBufferParameteri64v != nullptr) table.GetBufferParameteri64v = get_buffer_64;
  table.BindBuffer = bind_buffer;
  table.ClientActiveTexture = client_active_texture;
  table.VertexPointer = vertex_pointer;
  table.NormalPointer = normal_pointer;
  table.ColorPointer = color_pointer;
  table.TexCoordPointer = texture_coordinate_pointer;
  table.VertexAttribPointer = attribute_pointer;
}

}  // namespace understudy::spu
