// SPDX-License-Identifier: Apache-2.0
#include "tests/spu/stream/reading_driver.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>

#include "dispatch/call_words.h"
#include "spu/stream/bound_buffers.h"
#include "spu/stream/client_arrays.h"
#include "spu/stream/extent.h"
#include "spu/stream/image_answers.h"
#include "spu/stream/pixels.h"

namespace understudy::spu::testing {
namespace {

thread_local ReadingDriver* reading_driver = nullptr;

/// Keeps the buffers of random streams small.
constexpr std::uint64_t most_buffer_bytes = std::uint64_t(1) << 20;
constexpr std::size_t longest_parameter_bytes = 16 * sizeof(GLfloat);

std::byte* address(std::uint64_t word) {
  return reinterpret_cast<std::byte*>(static_cast<std::uintptr_t>(word));
}

std::uint64_t word_of(const void* pointer) {
  return reinterpret_cast<std::uintptr_t>(pointer);
}

/// Calls that are valid between glBegin and glEnd.
bool is_of_vertices(CallId call) {
  constexpr std::array<std::string_view, 14> beginnings = {
      "glVertex", "glNormal",   "glColor",    "glTexCoord",  "glMulti",    "glFogCoord",     "glSecondaryColor",
      "glIndex",  "glEdgeFlag", "glMaterial", "glEvalCoord", "glCallList", "glArrayElement", "glEnd"};
  const std::string_view name = call_name(call);
  return std::any_of(beginnings.begin(), beginnings.end(), [&](auto start) { return name.starts_with(start); });
}

[[noreturn]] void wrong(CallId call, const char* what) {
  std::fprintf(stderr, "%s: %s\n", call_name(call), what);
  std::abort();
}

}  // namespace

struct ReadingDriver::Slots {
  static std::uint64_t call(CallId call, const std::uint64_t* words) {
    return reading_driver->call(call, words);
  }

  template <class T>
  static void tell(std::optional<std::uint64_t> value, T* to) {
    if (value && !reading_driver->inside_) *to = T(*value);
  }
  static void APIENTRY get_integer(GLenum name, GLint* value) { tell(reading_driver->integer(name), value); }
  static void APIENTRY get_pointer(GLenum name, void** value) {
    if (!reading_driver->inside_) *value = address(reading_driver->pointer(name));
  }
  static GLboolean APIENTRY is_enabled(GLenum name) {
    const Array* array = reading_driver->array(name);
    return GLboolean(!reading_driver->inside_ && array != nullptr && array->enabled);
  }
  static GLboolean APIENTRY is_buffer(GLuint name) {
    return GLboolean(!reading_driver->inside_ && reading_driver->buffers_.contains(name));
  }
  static void tell_buffer(const Buffer* buffer, GLenum name, GLint64* value) {
    if (buffer == nullptr || reading_driver->inside_) return;
    if (name == GL_BUFFER_SIZE) *value = GLint64(buffer->bytes.size());
    if (name == GL_BUFFER_MAPPED) *value = buffer->mapped;
    if (name == GL_BUFFER_ACCESS) *value = buffer->access;
  }
  static void APIENTRY get_buffer64(GLenum target, GLenum name, GLint64* value) {
    tell_buffer(reading_driver->bound(target), name, value);
  }
  static void APIENTRY get_buffer(GLenum target, GLenum name, GLint* value) {
    GLint64 wide = *value;
    tell_buffer(reading_driver->bound(target), name, &wide);
    *value = GLint(wide);
  }
  static void APIENTRY get_named_buffer64(GLuint name, GLenum what, GLint64* value) {
    const auto found = reading_driver->buffers_.find(name);
    tell_buffer(found == reading_driver->buffers_.end() ? nullptr : &found->second, what, value);
  }
  static void APIENTRY get_named_buffer(GLuint name, GLenum what, GLint* value) {
    GLint64 wide = *value;
    get_named_buffer64(name, what, &wide);
    *value = GLint(wide);
  }
  static void APIENTRY get_buffer_pointer(GLenum target, GLenum, void** value) {
    Buffer* buffer = reading_driver->bound(target);
    if (buffer == nullptr || reading_driver->inside_) return;
    *value = buffer->mapped ? buffer->bytes.data() + buffer->mapped_at : nullptr;
  }
  static void APIENTRY get_attribute(GLuint index, GLenum name, GLint* value) {
    if (reading_driver->inside_ || index >= attributes) return;
    const Array& array = reading_driver->arrays_[3 + index];
    switch (name) {
      case GL_VERTEX_ATTRIB_ARRAY_ENABLED:
        *value = array.enabled;
        break;
      case GL_VERTEX_ATTRIB_ARRAY_BUFFER_BINDING:
        *value = GLint(array.buffer);
        break;
      case GL_VERTEX_ATTRIB_ARRAY_SIZE:
        *value = array.size;
        break;
      case GL_VERTEX_ATTRIB_ARRAY_TYPE:
        *value = GLint(array.type);
        break;
      case GL_VERTEX_ATTRIB_ARRAY_STRIDE:
        *value = array.stride;
        break;
      case GL_VERTEX_ATTRIB_ARRAY_DIVISOR:
        *value = GLint(array.divisor);
        break;
      default:
        *value = 0;
    }
  }
  static void APIENTRY get_attribute_pointer(GLuint index, GLenum, void** value) {
    if (!reading_driver->inside_ && index < attributes)
      *value = address(reading_driver->arrays_[3 + index].pointer);
  }
  static void APIENTRY get_level(GLenum, GLint, GLenum name, GLint* value) {
    *value = name == GL_TEXTURE_DEPTH || name == GL_TEXTURE_COMPRESSED ? 1 : 4;
  }
  static void APIENTRY get_named_level(GLuint, GLint level, GLenum name, GLint* value) {
    get_level(GL_NONE, level, name, value);
  }
  static void APIENTRY get_of_object(GLuint, GLenum, GLint* value) { *value = 3; }
  static void APIENTRY get_named_assembly(GLuint, GLenum, GLenum, GLint* value) { *value = 3; }
  static void APIENTRY get_assembly(GLenum, GLenum, GLint* value) {
    *value = GLint(reading_driver->program_text_);
  }
};

ReadingDriver::ReadingDriver() {
  reading_driver = this;
  AsWords<Slots>::fill(table_);
  table_.GetIntegerv = &Slots::get_integer;
  table_.GetPointerv = &Slots::get_pointer;
  table_.IsEnabled = &Slots::is_enabled;
  table_.IsBuffer = &Slots::is_buffer;
  table_.GetBufferParameteri64v = &Slots::get_buffer64;
  table_.GetBufferParameteriv = &Slots::get_buffer;
  table_.GetNamedBufferParameteri64v = &Slots::get_named_buffer64;
  table_.GetNamedBufferParameteriv = &Slots::get_named_buffer;
  table_.GetBufferPointerv = &Slots::get_buffer_pointer;
  table_.GetVertexAttribiv = &Slots::get_attribute;
  table_.GetVertexAttribPointerv = &Slots::get_attribute_pointer;
  table_.GetTexLevelParameteriv = &Slots::get_level;
  table_.GetTextureLevelParameteriv = &Slots::get_named_level;
  table_.GetTextureParameteriv = &Slots::get_of_object;
  table_.GetProgramiv = &Slots::get_of_object;
  table_.GetProgramivNV = &Slots::get_of_object;
  table_.GetNamedProgramivEXT = &Slots::get_named_assembly;
  table_.GetProgramivARB = &Slots::get_assembly;
  integers_ = {{GL_UNPACK_ALIGNMENT, 4}, {GL_PACK_ALIGNMENT, 4}};
}

ReadingDriver::~ReadingDriver() {
  reading_driver = nullptr;
}

void ReadingDriver::read(std::uint64_t from, std::size_t bytes) {
  const volatile std::byte* first = address(from);
  for (std::size_t i = 0; i < bytes; ++i) sum_ += std::to_integer<unsigned>(first[i]);
}

void ReadingDriver::write(std::uint64_t to, std::size_t bytes) {
  if (bytes > 0) std::memset(address(to), 0x21, bytes);
}

ReadingDriver::Buffer* ReadingDriver::bound(GLenum target) {
  const auto binding = bindings_.find(target);
  return binding == bindings_.end() || binding->second == 0 ? nullptr : &buffers_[binding->second];
}

/// Converts a pointer argument to an address: it is an offset while a buffer is bound.
std::uint64_t ReadingDriver::in_buffer(GLenum target, std::uint64_t pointer) {
  const Buffer* buffer = bound(target);
  return buffer == nullptr ? pointer : word_of(buffer->bytes.data()) + pointer;
}

std::optional<std::uint64_t> ReadingDriver::integer(GLenum name) const {
  for (const auto& [target, buffer] : bindings_) {
    if (binding_of_target(target) == name) return buffer;
  }
  const auto fixed = [&](std::size_t which) -> const Array& { return arrays_[which]; };
  switch (name) {
    case GL_MAX_VERTEX_ATTRIBS:
      return attributes;
    case GL_RENDER_MODE:
      return render_mode_;
    case GL_VERTEX_ARRAY_BUFFER_BINDING:
      return fixed(0).buffer;
    case GL_NORMAL_ARRAY_BUFFER_BINDING:
      return fixed(1).buffer;
    case GL_COLOR_ARRAY_BUFFER_BINDING:
      return fixed(2).buffer;
    case GL_VERTEX_ARRAY_SIZE:
      return fixed(0).size;
    case GL_COLOR_ARRAY_SIZE:
      return fixed(2).size;
    case GL_VERTEX_ARRAY_TYPE:
      return fixed(0).type;
    case GL_NORMAL_ARRAY_TYPE:
      return fixed(1).type;
    case GL_COLOR_ARRAY_TYPE:
      return fixed(2).type;
    default:
      break;
  }
  const auto found = integers_.find(name);
  return found == integers_.end() ? 0 : std::uint64_t(std::int64_t(found->second));
}

std::uint64_t ReadingDriver::pointer(GLenum name) const {
  switch (name) {
    case GL_FEEDBACK_BUFFER_POINTER:
      return feedback_.first;
    case GL_SELECTION_BUFFER_POINTER:
      return selection_.first;
    case GL_VERTEX_ARRAY_POINTER:
      return arrays_[0].pointer;
    case GL_NORMAL_ARRAY_POINTER:
      return arrays_[1].pointer;
    case GL_COLOR_ARRAY_POINTER:
      return arrays_[2].pointer;
    default:
      return 0;
  }
}

ReadingDriver::Array* ReadingDriver::array(GLenum name) {
  const bool known = name == GL_VERTEX_ARRAY || name == GL_NORMAL_ARRAY || name == GL_COLOR_ARRAY;
  return !known ? nullptr : &arrays_[name == GL_VERTEX_ARRAY ? 0 : name == GL_NORMAL_ARRAY ? 1 : 2];
}

ReadingDriver::Buffer* ReadingDriver::buffer_of(CallId call, const std::uint64_t* words) {
  if (std::string_view(call_name(call)).find("Named") == std::string_view::npos) return bound(GLenum(words[0]));
  const auto found = buffers_.find(GLuint(words[0]));
  return found == buffers_.end() ? nullptr : &found->second;
}

void ReadingDriver::set_data(Buffer& buffer, std::uint64_t bytes, std::uint64_t data) {
  if (bytes > most_buffer_bytes) return;
  buffer.mapped = false;
  // New memory each time, so that uses of the former memory are detected.
  std::vector<std::byte>(bytes).swap(buffer.bytes);
  if (data != 0 && bytes > 0) std::memcpy(buffer.bytes.data(), address(data), bytes);
}

std::uint64_t ReadingDriver::map(CallId call, const std::uint64_t* words) {
  Buffer* buffer = buffer_of(call, words);
  if (buffer == nullptr || buffer->mapped || buffer->bytes.empty()) return 0;
  const std::uint8_t length = argument_named(call_shape(call), "length");
  const std::uint64_t at = length == no_argument ? 0 : words[1];
  if (length != no_argument && (at > buffer->bytes.size() || words[length] > buffer->bytes.size() - at))
    return 0;
  buffer->mapped = true;
  buffer->mapped_at = at;
  return word_of(buffer->bytes.data() + at);
}

void ReadingDriver::delete_buffers(const std::uint64_t* words) {
  for (std::int32_t i = 0; i < std::int32_t(words[0]); ++i) {
    GLuint name = 0;
    std::memcpy(&name, address(words[1]) + std::size_t(i) * sizeof name, sizeof name);
    if (buffers_.erase(name) == 0) continue;
    std::erase_if(bindings_, [&](const auto& binding) { return binding.second == name; });
    // The offset stays, and is an address from now on.
    for (Array& array : arrays_) array.buffer = array.buffer == name ? 0 : array.buffer;
  }
}

std::optional<std::uint64_t> ReadingDriver::change_buffers(CallId call, const std::uint64_t* words) {
  Buffer* buffer = nullptr;
  switch (call) {
    case CallId::BindBuffer:
    case CallId::BindBufferARB:
      bindings_[GLenum(words[0])] = GLuint(words[1]);
      if (words[1] != 0) buffers_[GLuint(words[1])];
      return 0;
    case CallId::DeleteBuffers:
    case CallId::DeleteBuffersARB:
      delete_buffers(words);
      return 0;
    case CallId::BufferData:
    case CallId::BufferDataARB:
    case CallId::BufferStorage:
    case CallId::NamedBufferData:
    case CallId::NamedBufferStorage:
      if ((buffer = buffer_of(call, words)) != nullptr) set_data(*buffer, words[1], words[2]);
      return 0;
    case CallId::MapBuffer:
    case CallId::MapBufferRange:
    case CallId::MapNamedBuffer:
    case CallId::MapNamedBufferRange:
      return map(call, words);
    case CallId::UnmapBuffer:
    case CallId::UnmapBufferOES:
    case CallId::UnmapNamedBuffer:
      if ((buffer = buffer_of(call, words)) != nullptr) {
        buffer->mapped = false;
        std::vector<std::byte>(buffer->bytes).swap(buffer->bytes);
      }
      return GL_TRUE;
    default:
      return std::nullopt;
  }
}

void ReadingDriver::change_arrays(CallId call, const std::uint64_t* words) {
  const auto point = [&](Array& array, std::size_t size_at, std::size_t stride_at) {
    array.size = size_at == no_argument ? 3 : GLint(words[size_at]);
    array.type = GLenum(words[size_at == no_argument ? 0 : size_at + 1]);
    array.stride = GLsizei(words[stride_at]);
    array.pointer = words[stride_at + 1];
    const auto binding = bindings_.find(GL_ARRAY_BUFFER);
    array.buffer = binding == bindings_.end() ? 0 : binding->second;
  };
  switch (call) {
    case CallId::VertexPointer:
      return point(arrays_[0], 0, 2);
    case CallId::NormalPointer:
      return point(arrays_[1], no_argument, 1);
    case CallId::ColorPointer:
      return point(arrays_[2], 0, 2);
    case CallId::VertexAttribPointer:
      if (GLuint(words[0]) < attributes) point(arrays_[3 + GLuint(words[0])], 1, 4);
      return;
    case CallId::VertexAttribDivisor:
      if (GLuint(words[0]) < attributes) arrays_[3 + GLuint(words[0])].divisor = GLuint(words[1]);
      return;
    case CallId::EnableClientState:
    case CallId::DisableClientState:
      if (Array* named = array(GLenum(words[0]))) named->enabled = call == CallId::EnableClientState;
      return;
    case CallId::EnableVertexAttribArray:
    case CallId::DisableVertexAttribArray:
      if (GLuint(words[0]) < attributes)
        arrays_[3 + GLuint(words[0])].enabled = call == CallId::EnableVertexAttribArray;
      return;
    default:
      return;
  }
}

std::optional<std::uint64_t> ReadingDriver::change(CallId call, const std::uint64_t* words) {
  change_arrays(call, words);
  switch (call) {
    case CallId::Begin:
      // An invalid mode is an error.
      inside_ |= GLenum(words[0]) <= GL_POLYGON;
      return 0;
    case CallId::End:
      inside_ = false;
      return 0;
    case CallId::PixelStorei:
      if (std::int32_t(words[1]) >= 0) integers_[GLenum(words[0])] = GLint(words[1]);
      return 0;
    case CallId::ProgramStringARB:
      program_text_ = std::size_t(std::max(std::int32_t(words[2]), 0));
      return std::nullopt;
    case CallId::RenderMode: {
      const Retained& retained = render_mode_ == GL_FEEDBACK ? feedback_ : selection_;
      if (render_mode_ != GL_RENDER) write(retained.first, retained.bytes);
      render_mode_ = GLenum(words[0]);
      return 1;
    }
    case CallId::FeedbackBuffer:
      if (render_mode_ != GL_FEEDBACK) feedback_ = {words[2], std::size_t(std::max(GLint(words[0]), 0)) * 4};
      return 0;
    case CallId::SelectBuffer:
      if (render_mode_ != GL_SELECT) selection_ = {words[1], std::size_t(std::max(GLint(words[0]), 0)) * 4};
      return 0;
    default:
      return std::nullopt;
  }
}

void ReadingDriver::read_list(CallId call, std::size_t p, const std::uint64_t* words) {
  const CallShape& shape = call_shape(call);
  const bool texts = shape.parameters()[p].rule == ExtentRule::texts;
  const std::uint8_t lengths_at = argument_named(shape, texts ? "length" : "count");
  const auto* list = reinterpret_cast<const std::uint64_t*>(address(words[p]));
  const auto* lengths =
      lengths_at == no_argument ? nullptr : reinterpret_cast<const GLint*>(address(words[lengths_at]));
  const std::size_t size = texts ? 1 : component_size(GLenum(words[argument_named(shape, "type")]));
  for (std::int32_t i = 0; i < std::int32_t(words[shape.parameters()[p].counted_by]); ++i) {
    const GLint length = lengths != nullptr ? lengths[i] : -1;
    if (length >= 0) {
      read(list[i], std::size_t(length) * size);
    } else if (texts) {
      sum_ += std::strlen(reinterpret_cast<const char*>(address(list[i])));
    }
  }
}

void ReadingDriver::read_input(CallId call, std::size_t p, const std::uint64_t* words) {
  const ParameterShape& parameter = call_shape(call).parameters()[p];
  const bool means_null = parameter.null_with != no_argument && words[parameter.null_with] == 0;
  const auto point = buffer_point(parameter.rule);
  if (words[p] == 0 && means_null && !(point && bound(point->target) != nullptr)) return;
  switch (parameter.rule) {
    case ExtentRule::image: {
      const auto bytes = image_extent(image_shape(call, words), pixel_store(table_, unpack_names));
      if (bytes) read(in_buffer(GL_PIXEL_UNPACK_BUFFER, words[p]), *bytes);
      return;
    }
    case ExtentRule::counted_or_unpack: {
      // Skip values also apply to rows of compressed blocks.
      const PixelStore store = pixel_store(table_, unpack_names);
      const std::size_t skipped = std::size_t(store.skip_rows) * 16 + std::size_t(store.skip_pixels);
      const std::size_t bytes = pointee_bytes(call, p, words).value_or(0);
      if (bytes > 0) read(in_buffer(GL_PIXEL_UNPACK_BUFFER, words[p]), skipped + bytes);
      return;
    }
    case ExtentRule::indices:
    case ExtentRule::indirect:
      return read(in_buffer(point->target, words[p]), pointee_bytes(call, p, words).value_or(0));
    case ExtentRule::texts:
      return read_list(call, p, words);
    case ExtentRule::index_lists:
      if (bound(GL_ELEMENT_ARRAY_BUFFER) != nullptr) wrong(call, "a list of offsets");
      return read_list(call, p, words);
    case ExtentRule::parameter_values:
      return read(words[p], std::max(pointee_bytes(call, p, words).value_or(0), longest_parameter_bytes));
    case ExtentRule::client_array:
      return;
    case ExtentRule::address:
    case ExtentRule::unknown:
      if (words[p] != 0) wrong(call, "a pointer that nobody has measured");
      return;
    default:
      return read(words[p], pointee_bytes(call, p, words).value_or(0));
  }
}

void ReadingDriver::write_output(CallId call, std::size_t p, const std::uint64_t* words) {
  const ParameterShape& parameter = call_shape(call).parameters()[p];
  if (parameter.rule == ExtentRule::retained) return;
  if (words[p] == 0 && parameter.null_with == p) return;
  if (parameter.rule == ExtentRule::image_out) {
    const auto image = image_answer(call, words, table_);
    // If the caller's buffer is too small, nothing is written.
    if (!image || image->bytes == 0) return;
    const auto bytes =
        image->shape ? image_extent(*image->shape, pixel_store(table_, pack_names)) : image->bytes;
    if (bytes) write(in_buffer(GL_PIXEL_PACK_BUFFER, words[p]), *bytes);
    return;
  }
  if (call == CallId::GetProgramStringARB) return write(words[p], program_text_);
  // Writes names and values that reveal nothing about the driver.
  write(words[p], pointee_bytes(call, p, words).value_or(longest_parameter_bytes));
}

void ReadingDriver::touch(CallId call, std::size_t p, const std::uint64_t* words) {
  if (call_shape(call).parameters()[p].input) {
    read_input(call, p, words);
  } else {
    write_output(call, p, words);
  }
}

/// Reads client memory within the range of the call; buffer objects are the driver's own responsibility.
void ReadingDriver::draw(CallId call, const std::uint64_t* words) {
  const bool was_inside = std::exchange(inside_, false);
  const auto range = element_range(table_, call, words);
  inside_ = was_inside;
  if (range && range->empty()) return;
  for (const Array& array : arrays_) {
    if (!array.enabled || array.buffer != 0) continue;
    if (!range) wrong(call, "arrays in memory, and nobody knows how much of them");
    const ClientArray shape{.size = array.size, .type = array.type, .stride = array.stride};
    std::int64_t first = array.divisor == 0 ? range->first : range->first_instance;
    std::int64_t last =
        array.divisor == 0 ? range->last : first + (range->last_instance - first) / std::int64_t(array.divisor);
    const CallShape& of = call_shape(call);
    if (const std::uint8_t start = argument_named(of, "start");
        start != no_argument && array.divisor == 0 && !range->empty()) {
      first = std::min<std::int64_t>(first, GLuint(words[start]));
      last = std::max<std::int64_t>(last, GLuint(words[argument_named(of, "end")]));
    }
    for (std::int64_t i = first; i <= last && i < first + 10'000; ++i)
      read(array.pointer + std::uint64_t(i) * shape.step(), shape.element_bytes());
  }
}

std::uint64_t ReadingDriver::call(CallId call, const std::uint64_t* words) {
  ++calls_;
  if (inside_ && !is_of_vertices(call)) return 0;
  const auto parameters = call_shape(call).parameters();
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (parameters[p].pointer > 0) touch(call, p, words);
  }
  if (draws_arrays(call)) draw(call, words);
  if (const auto result = change_buffers(call, words)) return *result;
  return change(call, words).value_or(0);
}

}  // namespace understudy::spu::testing
