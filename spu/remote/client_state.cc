// SPDX-License-Identifier: Apache-2.0
#include "spu/remote/client_state.h"

#include <algorithm>
#include <string_view>

#include "dispatch/call_words.h"
#include "spu/remote/interleaved_arrays.h"
#include "spu/stream/bound_buffers.h"

namespace understudy::spu {
namespace {

/// The names that query a fixed-function array; 0 if there is no such query.
struct ArrayNames {
  GLenum array;
  GLenum size;
  GLenum type;
  GLenum stride;
  GLenum buffer;
  GLenum pointer;
};

constexpr std::array<ArrayNames, 8> array_names = {{
    {GL_VERTEX_ARRAY, GL_VERTEX_ARRAY_SIZE, GL_VERTEX_ARRAY_TYPE, GL_VERTEX_ARRAY_STRIDE,
     GL_VERTEX_ARRAY_BUFFER_BINDING, GL_VERTEX_ARRAY_POINTER},
    {GL_NORMAL_ARRAY, 0, GL_NORMAL_ARRAY_TYPE, GL_NORMAL_ARRAY_STRIDE, GL_NORMAL_ARRAY_BUFFER_BINDING,
     GL_NORMAL_ARRAY_POINTER},
    {GL_COLOR_ARRAY, GL_COLOR_ARRAY_SIZE, GL_COLOR_ARRAY_TYPE, GL_COLOR_ARRAY_STRIDE,
     GL_COLOR_ARRAY_BUFFER_BINDING, GL_COLOR_ARRAY_POINTER},
    {GL_SECONDARY_COLOR_ARRAY, GL_SECONDARY_COLOR_ARRAY_SIZE, GL_SECONDARY_COLOR_ARRAY_TYPE,
     GL_SECONDARY_COLOR_ARRAY_STRIDE, GL_SECONDARY_COLOR_ARRAY_BUFFER_BINDING,
     GL_SECONDARY_COLOR_ARRAY_POINTER},
    {GL_FOG_COORD_ARRAY, 0, GL_FOG_COORD_ARRAY_TYPE, GL_FOG_COORD_ARRAY_STRIDE,
     GL_FOG_COORD_ARRAY_BUFFER_BINDING, GL_FOG_COORD_ARRAY_POINTER},
    {GL_INDEX_ARRAY, 0, GL_INDEX_ARRAY_TYPE, GL_INDEX_ARRAY_STRIDE, GL_INDEX_ARRAY_BUFFER_BINDING,
     GL_INDEX_ARRAY_POINTER},
    {GL_EDGE_FLAG_ARRAY, 0, 0, GL_EDGE_FLAG_ARRAY_STRIDE, GL_EDGE_FLAG_ARRAY_BUFFER_BINDING,
     GL_EDGE_FLAG_ARRAY_POINTER},
    {GL_TEXTURE_COORD_ARRAY, GL_TEXTURE_COORD_ARRAY_SIZE, GL_TEXTURE_COORD_ARRAY_TYPE,
     GL_TEXTURE_COORD_ARRAY_STRIDE, GL_TEXTURE_COORD_ARRAY_BUFFER_BINDING, GL_TEXTURE_COORD_ARRAY_POINTER},
}};

const ArrayNames* names_of_array(GLenum array) {
  const auto* found = std::find_if(array_names.begin(), array_names.end(),
                                   [&](const ArrayNames& names) { return names.array == array; });
  return found == array_names.end() ? nullptr : found;
}

std::array<GLint PixelStore::*, 8> store_fields() {
  return {&PixelStore::swap_bytes,   &PixelStore::lsb_first, &PixelStore::row_length,
          &PixelStore::image_height, &PixelStore::skip_rows, &PixelStore::skip_pixels,
          &PixelStore::skip_images,  &PixelStore::alignment};
}

template <class T>
void write(std::uint64_t to, T value) {
  if (to != 0) *reinterpret_cast<T*>(static_cast<std::uintptr_t>(to)) = value;
}

}  // namespace

void ClientState::note_pixel_store(GLenum name, GLint value) {
  const auto fields = store_fields();
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const bool alignment = fields[i] == &PixelStore::alignment;
    if (value < 0 || (alignment && value != 1 && value != 2 && value != 4 && value != 8)) continue;
    const GLint kept = i < 2 ? GLint(value != 0) : value;
    if (name == unpack_names[i]) client_.unpack.*fields[i] = kept;
    if (name == pack_names[i]) client_.pack.*fields[i] = kept;
  }
}

void ClientState::bind_buffer(GLenum target, GLuint buffer) {
  if (target == GL_ARRAY_BUFFER) {
    client_.array_buffer = buffer;
  } else if (target == GL_ELEMENT_ARRAY_BUFFER) {
    element_buffers_[client_.vertex_array] = buffer;
  } else {
    buffers_[target] = buffer;
  }
}

GLuint ClientState::bound_buffer(GLenum target) const {
  if (target == GL_ARRAY_BUFFER) return client_.array_buffer;
  const bool elements = target == GL_ELEMENT_ARRAY_BUFFER;
  const auto& bindings = elements ? element_buffers_ : buffers_;
  const auto found = bindings.find(elements ? client_.vertex_array : target);
  return found == bindings.end() ? 0 : found->second;
}

void ClientState::delete_buffers(GLsizei count, const GLuint* buffers) {
  for (GLsizei i = 0; i < count && buffers != nullptr; ++i) {
    const GLuint gone = buffers[i];
    if (gone == 0) continue;
    if (client_.array_buffer == gone) client_.array_buffer = 0;
    for (auto& [target, bound] : buffers_) bound = bound == gone ? 0 : bound;
    if (bound_buffer(GL_ELEMENT_ARRAY_BUFFER) == gone) element_buffers_[client_.vertex_array] = 0;
    if (client_.vertex_array != 0) continue;
    for (auto* arrays : {&client_.texture_coordinates, &client_.generic}) {
      for (auto& [index, array] : *arrays) array.buffer = array.buffer == gone ? 0 : array.buffer;
    }
    for (auto& [name, array] : client_.fixed) array.buffer = array.buffer == gone ? 0 : array.buffer;
  }
}

void ClientState::point(Array& array, GLint size, GLenum type, std::uint64_t stride, std::uint64_t pointer) {
  if (client_.vertex_array != 0) return;
  array.size = size;
  array.type = type;
  array.stride = GLsizei(std::int32_t(stride));
  array.pointer = pointer;
  array.buffer = client_.array_buffer;
  array.elsewhere = false;
}

/// `unit` is for texture coordinates.
void ClientState::enable_array(GLenum array, GLuint unit, bool enabled) {
  if (client_.vertex_array != 0) return;
  if (array == GL_TEXTURE_COORD_ARRAY) {
    client_.texture_coordinates[unit].enabled = enabled;
  } else if (names_of_array(array) != nullptr) {
    client_.fixed[array].enabled = enabled;
  }
}

void ClientState::push(GLbitfield mask) {
  pushed_.push_back({mask, client_, bound_buffer(GL_PIXEL_UNPACK_BUFFER), bound_buffer(GL_PIXEL_PACK_BUFFER),
                     bound_buffer(GL_ELEMENT_ARRAY_BUFFER)});
}

void ClientState::pop() {
  if (pushed_.empty()) return;
  const Pushed& pushed = pushed_.back();
  if ((pushed.mask & GL_CLIENT_PIXEL_STORE_BIT) != 0) {
    client_.unpack = pushed.client.unpack;
    client_.pack = pushed.client.pack;
    bind_buffer(GL_PIXEL_UNPACK_BUFFER, pushed.unpack_buffer);
    bind_buffer(GL_PIXEL_PACK_BUFFER, pushed.pack_buffer);
  }
  if ((pushed.mask & GL_CLIENT_VERTEX_ARRAY_BIT) != 0) {
    Client restored = pushed.client;
    restored.unpack = client_.unpack;
    restored.pack = client_.pack;
    client_ = std::move(restored);
    bind_buffer(GL_ELEMENT_ARRAY_BUFFER, pushed.element_buffer);
  }
  pushed_.pop_back();
}

/// glClientAttribDefaultEXT.
void ClientState::reset(GLbitfield mask) {
  if ((mask & GL_CLIENT_PIXEL_STORE_BIT) != 0) {
    client_.unpack = {};
    client_.pack = {};
    bind_buffer(GL_PIXEL_UNPACK_BUFFER, 0);
    bind_buffer(GL_PIXEL_PACK_BUFFER, 0);
  }
  if ((mask & GL_CLIENT_VERTEX_ARRAY_BIT) == 0) return;
  client_.active_texture = 0;
  client_.array_buffer = 0;
  bind_buffer(GL_ELEMENT_ARRAY_BUFFER, 0);
  if (client_.vertex_array != 0) return;
  client_.fixed.clear();
  client_.texture_coordinates.clear();
  for (auto& [index, array] : client_.generic) array = {.divisor = array.divisor};
}

/// Tracks the gl*Pointer commands; arguments are in the order of the registry. Those of EXT_vertex_array have a
/// number of elements before the pointer.
void ClientState::follow_pointer(CallId call, const std::uint64_t* words) {
  const auto fixed = [&](GLenum array, GLint size, GLenum type, std::uint64_t stride, std::uint64_t pointer) {
    point(client_.fixed[array], size, type, stride, pointer);
  };
  const auto size = GLint(words[0]);
  switch (call) {
    case CallId::VertexPointer:
      return fixed(GL_VERTEX_ARRAY, size, GLenum(words[1]), words[2], words[3]);
    case CallId::VertexPointerEXT:
      return fixed(GL_VERTEX_ARRAY, size, GLenum(words[1]), words[2], words[4]);
    case CallId::NormalPointer:
      return fixed(GL_NORMAL_ARRAY, 3, GLenum(words[0]), words[1], words[2]);
    case CallId::NormalPointerEXT:
      return fixed(GL_NORMAL_ARRAY, 3, GLenum(words[0]), words[1], words[3]);
    case CallId::ColorPointer:
      return fixed(GL_COLOR_ARRAY, size, GLenum(words[1]), words[2], words[3]);
    case CallId::ColorPointerEXT:
      return fixed(GL_COLOR_ARRAY, size, GLenum(words[1]), words[2], words[4]);
    case CallId::SecondaryColorPointer:
    case CallId::SecondaryColorPointerEXT:
      return fixed(GL_SECONDARY_COLOR_ARRAY, size, GLenum(words[1]), words[2], words[3]);
    case CallId::FogCoordPointer:
    case CallId::FogCoordPointerEXT:
      return fixed(GL_FOG_COORD_ARRAY, 1, GLenum(words[0]), words[1], words[2]);
    case CallId::IndexPointer:
      return fixed(GL_INDEX_ARRAY, 1, GLenum(words[0]), words[1], words[2]);
    case CallId::IndexPointerEXT:
      return fixed(GL_INDEX_ARRAY, 1, GLenum(words[0]), words[1], words[3]);
    case CallId::EdgeFlagPointer:
      return fixed(GL_EDGE_FLAG_ARRAY, 1, GL_UNSIGNED_BYTE, words[0], words[1]);
    case CallId::EdgeFlagPointerEXT:
      return fixed(GL_EDGE_FLAG_ARRAY, 1, GL_UNSIGNED_BYTE, words[0], words[2]);
    case CallId::TexCoordPointer:
    case CallId::TexCoordPointerEXT:
      return point(client_.texture_coordinates[client_.active_texture], size, GLenum(words[1]), words[2],
                   words[call == CallId::TexCoordPointerEXT ? 4 : 3]);
    case CallId::MultiTexCoordPointerEXT:
      return point(client_.texture_coordinates[GLuint(words[0]) - GL_TEXTURE0], GLint(words[1]),
                   GLenum(words[2]), words[3], words[4]);
    case CallId::InterleavedArrays:
      return point_interleaved(GLenum(words[0]), GLsizei(words[1]), words[2]);
    default:
      break;
  }
  const bool full = call == CallId::VertexAttribPointer || call == CallId::VertexAttribPointerARB;
  const std::size_t stride_at = full ? 4 : 3;
  if (client_.vertex_array != 0) return;
  Array& array = client_.generic[GLuint(words[0])];
  point(array, GLint(words[1]), GLenum(words[2]), words[stride_at], words[stride_at + 1]);
  array.normalized = full && words[3] != 0;
  array.integer = call == CallId::VertexAttribIPointer || call == CallId::VertexAttribIPointerEXT;
  array.wide = call == CallId::VertexAttribLPointer || call == CallId::VertexAttribLPointerEXT;
}

/// The equivalent commands of OpenGL 2.1, section 2.8.
void ClientState::point_interleaved(GLenum format, GLsizei stride, std::uint64_t pointer) {
  const InterleavedFormat* const is = interleaved_format(format);
  if (is == nullptr || stride < 0) return;
  const std::uint64_t step = stride == 0 ? is->bytes() : std::uint64_t(stride);
  const GLuint unit = client_.active_texture;
  for (const GLenum unused : {GL_EDGE_FLAG_ARRAY, GL_INDEX_ARRAY, GL_SECONDARY_COLOR_ARRAY, GL_FOG_COORD_ARRAY})
    enable_array(unused, unit, false);
  enable_array(GL_TEXTURE_COORD_ARRAY, unit, is->texture_coordinates != 0);
  enable_array(GL_COLOR_ARRAY, unit, is->color != 0);
  enable_array(GL_NORMAL_ARRAY, unit, is->normal);
  enable_array(GL_VERTEX_ARRAY, unit, true);
  if (is->texture_coordinates != 0)
    point(client_.texture_coordinates[unit], is->texture_coordinates, GL_FLOAT, step, pointer);
  if (is->color != 0)
    point(client_.fixed[GL_COLOR_ARRAY], is->color, is->color_type, step, pointer + is->color_at());
  if (is->normal) point(client_.fixed[GL_NORMAL_ARRAY], 3, GL_FLOAT, step, pointer + is->normal_at());
  point(client_.fixed[GL_VERTEX_ARRAY], is->position, GL_FLOAT, step, pointer + is->position_at());
}

void ClientState::follow_vertex_array(CallId call, const std::uint64_t* words) {
  switch (call) {
    case CallId::BindVertexArray:
      client_.vertex_array = GLuint(words[0]);
      return;
    case CallId::DeleteVertexArrays: {
      const auto* names = reinterpret_cast<const GLuint*>(static_cast<std::uintptr_t>(words[1]));
      for (GLsizei i = 0; i < GLsizei(words[0]) && names != nullptr; ++i) {
        if (names[i] == 0) continue;
        element_buffers_.erase(names[i]);
        if (client_.vertex_array == names[i]) client_.vertex_array = 0;
      }
      return;
    }
    case CallId::VertexArrayElementBuffer:
      element_buffers_[GLuint(words[0])] = GLuint(words[1]);
      return;
    case CallId::EnableVertexAttribArray:
    case CallId::EnableVertexAttribArrayARB:
    case CallId::DisableVertexAttribArray:
    case CallId::DisableVertexAttribArrayARB:
      if (client_.vertex_array == 0) {
        client_.generic[GLuint(words[0])].enabled =
            call == CallId::EnableVertexAttribArray || call == CallId::EnableVertexAttribArrayARB;
      }
      return;
    case CallId::EnableVertexArrayAttrib:
    case CallId::DisableVertexArrayAttrib:
      if (words[0] == 0) client_.generic[GLuint(words[1])].enabled = call == CallId::EnableVertexArrayAttrib;
      return;
    case CallId::VertexAttribDivisor:
    case CallId::VertexAttribDivisorARB:
      if (client_.vertex_array == 0) client_.generic[GLuint(words[0])].divisor = GLuint(words[1]);
      return;
    case CallId::VertexAttribFormat:
    case CallId::VertexAttribIFormat:
    case CallId::VertexAttribLFormat:
    case CallId::VertexAttribBinding:
    case CallId::BindVertexBuffer:
      if (client_.vertex_array == 0) client_.generic[GLuint(words[0])].elsewhere = true;
      return;
    default:
      return;
  }
}

void ClientState::note(CallId call, const std::uint64_t* words) {
  switch (call) {
    case CallId::PixelStorei:
      return note_pixel_store(GLenum(words[0]), GLint(words[1]));
    case CallId::PixelStoref:
      return note_pixel_store(GLenum(words[0]), GLint(argument<float>(words[1])));
    case CallId::BindBuffer:
    case CallId::BindBufferARB:
      return bind_buffer(GLenum(words[0]), GLuint(words[1]));
    case CallId::BindBufferBase:
    case CallId::BindBufferRange:
    case CallId::BindBufferBaseEXT:
    case CallId::BindBufferRangeEXT:
      return bind_buffer(GLenum(words[0]), GLuint(words[2]));
    case CallId::DeleteBuffers:
    case CallId::DeleteBuffersARB:
      return delete_buffers(GLsizei(words[0]),
                            reinterpret_cast<const GLuint*>(static_cast<std::uintptr_t>(words[1])));
    case CallId::FeedbackBuffer:
      feedback_ = {words[2], std::size_t(std::max<std::int64_t>(std::int32_t(words[0]), 0)) * 4};
      return;
    case CallId::SelectBuffer:
      selection_ = {words[1], std::size_t(std::max<std::int64_t>(std::int32_t(words[0]), 0)) * 4};
      return;
    case CallId::RenderMode:
      left_mode_ = mode_;
      mode_ = GLenum(words[0]);
      return;
    case CallId::PushClientAttrib:
      return push(GLbitfield(words[0]));
    case CallId::PushClientAttribDefaultEXT:
      push(GLbitfield(words[0]));
      return reset(GLbitfield(words[0]));
    case CallId::ClientAttribDefaultEXT:
      return reset(GLbitfield(words[0]));
    case CallId::PopClientAttrib:
      return pop();
    default:
      return follow_arrays(call, words);
  }
}

void ClientState::follow_arrays(CallId call, const std::uint64_t* words) {
  switch (call) {
    case CallId::ClientActiveTexture:
    case CallId::ClientActiveTextureARB:
      client_.active_texture = GLenum(words[0]) - GL_TEXTURE0;
      return;
    case CallId::EnableClientState:
      restarts_ |= GLenum(words[0]) == GL_PRIMITIVE_RESTART_NV;
      return enable_array(GLenum(words[0]), client_.active_texture, true);
    case CallId::DisableClientState:
      return enable_array(GLenum(words[0]), client_.active_texture, false);
    case CallId::EnableClientStateiEXT:
    case CallId::EnableClientStateIndexedEXT:
      return enable_array(GLenum(words[0]), GLuint(words[1]), true);
    case CallId::DisableClientStateiEXT:
    case CallId::DisableClientStateIndexedEXT:
      return enable_array(GLenum(words[0]), GLuint(words[1]), false);
    case CallId::Enable:
      restarts_ |=
          GLenum(words[0]) == GL_PRIMITIVE_RESTART || GLenum(words[0]) == GL_PRIMITIVE_RESTART_FIXED_INDEX;
      return;
    case CallId::VertexPointer:
    case CallId::VertexPointerEXT:
    case CallId::NormalPointer:
    case CallId::NormalPointerEXT:
    case CallId::ColorPointer:
    case CallId::ColorPointerEXT:
    case CallId::SecondaryColorPointer:
    case CallId::SecondaryColorPointerEXT:
    case CallId::FogCoordPointer:
    case CallId::FogCoordPointerEXT:
    case CallId::IndexPointer:
    case CallId::IndexPointerEXT:
    case CallId::EdgeFlagPointer:
    case CallId::EdgeFlagPointerEXT:
    case CallId::TexCoordPointer:
    case CallId::TexCoordPointerEXT:
    case CallId::MultiTexCoordPointerEXT:
    case CallId::InterleavedArrays:
    case CallId::VertexAttribPointer:
    case CallId::VertexAttribPointerARB:
    case CallId::VertexAttribIPointer:
    case CallId::VertexAttribIPointerEXT:
    case CallId::VertexAttribLPointer:
    case CallId::VertexAttribLPointerEXT:
      return follow_pointer(call, words);
    default:
      return follow_vertex_array(call, words);
  }
}

const ClientState::Array& ClientState::fixed_array(GLenum array) const {
  static const Array untouched;
  const auto find = [](const auto& arrays, auto key) -> const Array& {
    const auto found = arrays.find(key);
    return found == arrays.end() ? untouched : found->second;
  };
  if (array == GL_TEXTURE_COORD_ARRAY) return find(client_.texture_coordinates, client_.active_texture);
  return find(client_.fixed, array);
}

const ClientState::Array& ClientState::generic_array(GLuint index) const {
  static const Array untouched;
  const auto found = client_.generic.find(index);
  return found == client_.generic.end() ? untouched : found->second;
}

std::optional<GLint> ClientState::array_value(GLenum name) const {
  for (const ArrayNames& names : array_names) {
    if (name == 0) break;
    if (name != names.size && name != names.type && name != names.stride && name != names.buffer) continue;
    const Array& array = fixed_array(names.array);
    if (name == names.size) return array.size;
    if (name == names.type) return GLint(array.type);
    return name == names.stride ? array.stride : GLint(array.buffer);
  }
  return std::nullopt;
}

std::optional<GLint> ClientState::value(GLenum name, Asker asker) const {
  const auto fields = store_fields();
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (name == unpack_names[i]) return client_.unpack.*fields[i];
    if (name == pack_names[i]) return client_.pack.*fields[i];
  }
  switch (name) {
    case GL_ARRAY_BUFFER_BINDING:
      return GLint(client_.array_buffer);
    case GL_ELEMENT_ARRAY_BUFFER_BINDING:
      return GLint(bound_buffer(GL_ELEMENT_ARRAY_BUFFER));
    case GL_PIXEL_PACK_BUFFER_BINDING:
      return GLint(bound_buffer(GL_PIXEL_PACK_BUFFER));
    case GL_PIXEL_UNPACK_BUFFER_BINDING:
      return GLint(bound_buffer(GL_PIXEL_UNPACK_BUFFER));
    case GL_DRAW_INDIRECT_BUFFER_BINDING:
      return GLint(bound_buffer(GL_DRAW_INDIRECT_BUFFER));
    case GL_VERTEX_ARRAY_BINDING:
      return GLint(client_.vertex_array);
    case GL_CLIENT_ACTIVE_TEXTURE:
      return GLint(GL_TEXTURE0 + client_.active_texture);
    default:
      // Extensions bind buffers by calls that are not tracked here, so an application's query is sent.
      if (const GLenum target = target_of_binding(name); target != GL_NONE && asker == Asker::encoder)
        return GLint(bound_buffer(target));
      return client_.vertex_array == 0 ? array_value(name) : std::nullopt;
  }
}

std::optional<GLint> ClientState::attribute_value(GLuint index, GLenum name, Asker asker) const {
  const Array& array = generic_array(index);
  const bool not_in_client_memory = client_.vertex_array != 0 || array.elsewhere;
  if (not_in_client_memory) {
    if (asker == Asker::application) return std::nullopt;
    if (name == GL_VERTEX_ATTRIB_ARRAY_ENABLED) return 0;
  }
  switch (name) {
    case GL_VERTEX_ATTRIB_ARRAY_ENABLED:
      return GLint(array.enabled);
    case GL_VERTEX_ATTRIB_ARRAY_BUFFER_BINDING:
      return GLint(array.buffer);
    case GL_VERTEX_ATTRIB_ARRAY_SIZE:
      return array.size;
    case GL_VERTEX_ATTRIB_ARRAY_TYPE:
      return GLint(array.type);
    case GL_VERTEX_ATTRIB_ARRAY_NORMALIZED:
      return GLint(array.normalized);
    case GL_VERTEX_ATTRIB_ARRAY_STRIDE:
      return array.stride;
    case GL_VERTEX_ATTRIB_ARRAY_INTEGER:
      return GLint(array.integer);
    case GL_VERTEX_ATTRIB_ARRAY_LONG:
      return GLint(array.wide);
    case GL_VERTEX_ATTRIB_ARRAY_DIVISOR:
      return GLint(array.divisor);
    default:
      return std::nullopt;
  }
}

std::optional<std::uint64_t> ClientState::pointer(GLenum name) const {
  if (name == GL_FEEDBACK_BUFFER_POINTER) return feedback_.first;
  if (name == GL_SELECTION_BUFFER_POINTER) return selection_.first;
  for (const ArrayNames& names : array_names) {
    if (name == names.pointer && client_.vertex_array == 0) return fixed_array(names.array).pointer;
  }
  return std::nullopt;
}

bool ClientState::answer_enabled(GLenum name, Asker asker, std::uint64_t& result) const {
  if (names_of_array(name) != nullptr) {
    if (client_.vertex_array != 0 && asker == Asker::application) return false;
    result = client_.vertex_array == 0 && fixed_array(name).enabled ? GL_TRUE : GL_FALSE;
    return true;
  }
  const bool restart = name == GL_PRIMITIVE_RESTART || name == GL_PRIMITIVE_RESTART_FIXED_INDEX ||
                       name == GL_PRIMITIVE_RESTART_NV;
  if (!restart || restarts_ || asker == Asker::application) return false;
  result = GL_FALSE;
  return true;
}

bool ClientState::answer(CallId call, const std::uint64_t* words, Asker asker, std::uint64_t& result) const {
  result = 0;
  switch (call) {
    case CallId::GetIntegerv:
    case CallId::GetInteger64v:
    case CallId::GetFloatv:
    case CallId::GetDoublev:
    case CallId::GetBooleanv: {
      const auto known = value(GLenum(words[0]), asker);
      if (!known) return false;
      if (call == CallId::GetIntegerv) write<GLint>(words[1], *known);
      if (call == CallId::GetInteger64v) write<GLint64>(words[1], *known);
      if (call == CallId::GetFloatv) write<GLfloat>(words[1], GLfloat(*known));
      if (call == CallId::GetDoublev) write<GLdouble>(words[1], *known);
      if (call == CallId::GetBooleanv) write<GLboolean>(words[1], *known != 0 ? GL_TRUE : GL_FALSE);
      return true;
    }
    case CallId::IsEnabled:
      return answer_enabled(GLenum(words[0]), asker, result);
    case CallId::GetVertexAttribiv: {
      const auto known = attribute_value(GLuint(words[0]), GLenum(words[1]), asker);
      if (known) write<GLint>(words[2], *known);
      return known.has_value();
    }
    case CallId::GetVertexAttribPointerv:
    case CallId::GetVertexAttribPointervARB:
      if (client_.vertex_array != 0 || generic_array(GLuint(words[0])).elsewhere) return false;
      write<std::uint64_t>(words[2], generic_array(GLuint(words[0])).pointer);
      return true;
    case CallId::GetPointerv:
    case CallId::GetPointervEXT: {
      const auto known = pointer(GLenum(words[0]));
      if (known) write<std::uint64_t>(words[1], *known);
      return known.has_value();
    }
    default:
      return false;
  }
}

}  // namespace understudy::spu
