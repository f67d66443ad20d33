#include "spu/stream/decode.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <span>
#include <string_view>

#include "dispatch/call_words.h"
#include "spu/stream/answers.h"
#include "spu/stream/decoded_call.h"
#include "spu/stream/event.h"
#include "spu/stream/extent.h"

namespace understudy::spu {
namespace {

/// Answers of calls whose extent nobody knows are smaller than this.
constexpr std::size_t unknown_output_bytes = std::size_t(64) * 1024;
/// Answers of a stream from elsewhere are given no more memory than this: a length there is only a claim.
constexpr std::size_t most_output_bytes = std::size_t(64) << 20;

const std::byte* address(std::uint64_t word) {
  return reinterpret_cast<const std::byte*>(static_cast<std::uintptr_t>(word));
}

std::uint64_t word_of(const void* pointer) {
  return reinterpret_cast<std::uintptr_t>(pointer);
}

GLint ask(const DispatchTable& gl, GLenum name) {
  GLint value = 0;
  gl.GetIntegerv(name, &value);
  return value;
}

/// Asks and changes nothing: a stream from elsewhere knows the answer already.
bool only_asks(CallId call) {
  const std::string_view name = call_name(call);
  if (name.starts_with("glGetUniformLocation")) return false;
  return name.starts_with("glGet") || name.starts_with("glIs") || name.starts_with("glAre");
}

/// Kinds that contexts of a share group have in common.
bool is_shared(ObjectKind kind) {
  switch (kind) {
    case ObjectKind::framebuffer:
    case ObjectKind::vertex_array:
    case ObjectKind::query:
    case ObjectKind::transform_feedback:
    case ObjectKind::program_pipeline:
      return false;
    default:
      return true;
  }
}

std::string in_call(CallId call, std::string_view what) {
  return fmt::format("{}: {}", call_name(call), what);
}

/// Bytes of the mapping that the call has just made.
std::size_t mapped_bytes(CallId call, const std::uint64_t* words, const DispatchTable& gl) {
  const std::uint8_t length = argument_named(call_shape(call), "length");
  if (length != no_argument) return words[length];
  GLint64 size = 0;
  if (call == CallId::MapNamedBuffer || call == CallId::MapNamedBufferEXT) {
    gl.GetNamedBufferParameteri64v(GLuint(words[0]), GL_BUFFER_SIZE, &size);
  } else {
    gl.GetBufferParameteri64v(GLenum(words[0]), GL_BUFFER_SIZE, &size);
  }
  return std::size_t(std::max<GLint64>(size, 0));
}

}  // namespace

/// The answer goes to a bound buffer object, where later calls find it.
bool Decoder::answers_into_buffer(const Call& call) {
  const auto parameters = call.shape->parameters();
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (parameters[p].rule == ExtentRule::image_out && call.kinds[p] == ReferenceKind::address) return true;
  }
  return false;
}

ObjectNames& Decoder::names(ObjectKind kind) {
  return shared_names_ && is_shared(kind) ? *shared_names_ : own_names_;
}

std::uint64_t* Decoder::scratch(std::size_t bytes) {
  if (scratch_used_ == scratch_.size()) scratch_.emplace_back();
  std::vector<std::uint64_t>& memory = scratch_[scratch_used_++];
  memory.assign(std::max<std::size_t>(words_for(bytes), 1), 0);
  return memory.data();
}

std::string Decoder::read_bytes(const Record& record, Call& call, std::size_t p) {
  const auto bytes = record.bytes(record.words[p + 1]);
  if (!bytes)
    return in_call(call.id, fmt::format("{} leads out of the stream", call.shape->parameters()[p].name()));
  call.words[p] = word_of(bytes->data());
  call.bytes[p] = bytes->size();
  return {};
}

std::string Decoder::read_strings(const Record& record, Call& call, std::size_t p) {
  const ParameterShape& parameter = call.shape->parameters()[p];
  const auto bytes = record.bytes(record.words[p + 1]);
  const std::int64_t count =
      parameter.counted_by == no_argument ? -1 : std::int32_t(call.words[parameter.counted_by]);
  if (!bytes || parameter.rule != ExtentRule::texts || (count > 0 && std::uint64_t(count) > bytes->size() / 8))
    return in_call(call.id, fmt::format("{} is no list of strings", parameter.name()));
  const std::uint8_t lengths_at = argument_named(*call.shape, "length");
  const GLint* lengths = nullptr;
  if (lengths_at != no_argument && call.words[lengths_at] != 0) {
    if (call.bytes[lengths_at] < std::size_t(std::max<std::int64_t>(count, 0)) * sizeof(GLint))
      return in_call(call.id, "there are fewer lengths than strings");
    lengths = reinterpret_cast<const GLint*>(address(call.words[lengths_at]));
  }
  std::uint64_t* list = scratch(std::size_t(std::max<std::int64_t>(count, 0)) * sizeof(void*));
  std::size_t at = 0;
  for (std::int64_t i = 0; i < count; ++i) {
    std::uint64_t length = 0;
    if (bytes->size() - at < 8) return in_call(call.id, "a string is missing");
    std::memcpy(&length, bytes->data() + at, 8);
    at += 8;
    if (length >= bytes->size() - at || words_for(length + 1) * 8 > bytes->size() - at ||
        bytes->data()[at + length] != std::byte(0) ||
        (lengths != nullptr && lengths[i] > std::int64_t(length))) {
      return in_call(call.id, "a string is longer than what there is of it");
    }
    list[i] = word_of(bytes->data() + at);
    at += words_for(length + 1) * 8;
  }
  call.words[p] = word_of(list);
  call.bytes[p] = std::size_t(std::max<std::int64_t>(count, 0)) * sizeof(void*);
  return {};
}

std::string Decoder::read_lists(const Record& record, Call& call, std::size_t p) {
  const ParameterShape& parameter = call.shape->parameters()[p];
  const auto bytes = record.bytes(record.words[p + 1]);
  const std::uint8_t counts_at = argument_named(*call.shape, "count");
  const std::uint8_t type_at = argument_named(*call.shape, "type");
  if (!bytes || parameter.rule != ExtentRule::index_lists || counts_at == no_argument || type_at == no_argument)
    return in_call(call.id, fmt::format("{} is no list of indices", parameter.name()));
  const auto count = std::size_t(std::max<std::int64_t>(std::int32_t(call.words[parameter.counted_by]), 0));
  if (count > bytes->size() / 8 || call.bytes[counts_at] < count * sizeof(GLsizei))
    return in_call(call.id, "there are fewer lists of indices than draws");
  const auto* counts = reinterpret_cast<const GLsizei*>(address(call.words[counts_at]));
  const std::size_t size = component_size(GLenum(call.words[type_at]));
  std::uint64_t* list = scratch(count * sizeof(void*));
  std::size_t at = 0;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t length = 0;
    if (bytes->size() - at < 8) return in_call(call.id, "a list of indices is missing");
    std::memcpy(&length, bytes->data() + at, 8);
    at += 8;
    if (length > bytes->size() - at || words_for(length) * 8 > bytes->size() - at ||
        length < std::size_t(std::max(counts[i], 0)) * size) {
      return in_call(call.id, "a list of indices is longer than what there is of it");
    }
    list[i] = length == 0 ? 0 : word_of(bytes->data() + at);
    at += words_for(length) * 8;
  }
  call.words[p] = word_of(list);
  return {};
}

std::string Decoder::read_arguments(const Record& record, Call& call) {
  const auto found = find_stable_id(record.id);
  if (!found) return fmt::format("call id {:#010x} is not in this registry", record.id);
  call.id = *found;
  call.shape = &call_shape(call.id);
  const auto parameters = call.shape->parameters();
  if (record.words.size() < parameters.size() + 1)
    return in_call(call.id,
                   fmt::format("has {} arguments here, not {}", parameters.size(), record.words.size() - 1));
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    call.words[p] = record.words[p + 1];
    if (parameters[p].pointer == 0) continue;
    const Reference reference = Reference::from(record.words[p + 1]);
    call.kinds[p] = reference.kind;
    call.words[p] = reference.kind == ReferenceKind::null ? 0 : reference.value;
    if (reference.kind == ReferenceKind::inside || reference.kind == ReferenceKind::payload) {
      if (std::string error = read_bytes(record, call, p); !error.empty()) return error;
    } else if (reference.kind > ReferenceKind::lists) {
      return in_call(call.id, fmt::format("{} is no reference", parameters[p].name()));
    }
  }
  // These count by other arguments, so they come when those are there.
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    std::string error;
    if (call.kinds[p] == ReferenceKind::strings) error = read_strings(record, call, p);
    if (call.kinds[p] == ReferenceKind::lists) error = read_lists(record, call, p);
    if (!error.empty()) return error;
  }
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const ParameterShape& parameter = parameters[p];
    if (call.kinds[p] != ReferenceKind::inside && call.kinds[p] != ReferenceKind::payload) continue;
    const bool text =
        parameter.rule == ExtentRule::text ||
        (parameter.rule == ExtentRule::text_or_counted && std::int32_t(call.words[parameter.counted_by]) < 0);
    if (text) {
      if (std::memchr(address(call.words[p]), 0, call.bytes[p]) == nullptr)
        return in_call(call.id, fmt::format("{} does not end", parameter.name()));
      continue;
    }
    const auto needed = parameter.rule == ExtentRule::image
                            ? image_extent(image_shape(call.id, call.words.data()), tight_pixels)
                            : pointee_bytes(call.id, p, call.words.data());
    if (!needed || *needed > call.bytes[p]) {
      return in_call(call.id, fmt::format("{} needs {} bytes and has {}", parameter.name(),
                                          needed ? std::to_string(*needed) : "unknown", call.bytes[p]));
    }
    call.image_in |= parameter.rule == ExtentRule::image;
  }
  return {};
}

std::string Decoder::arguments(const Record& record, CallId& id, std::uint64_t* words) {
  scratch_used_ = 0;
  Call call;
  std::string error = read_arguments(record, call);
  id = call.id;
  std::copy_n(call.words.begin(), error.empty() ? call.shape->parameter_count : 0, words);
  return error;
}

/// Names of the sender's objects become ours. False when the call means nothing here.
bool Decoder::translate(Call& call) {
  const auto parameters = call.shape->parameters();
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const ParameterShape& parameter = parameters[p];
    if (parameter.pointer == 0) {
      if (parameter.object == ObjectKind::sync) {
        const std::uint64_t here = names(parameter.object).here(parameter.object, call.words[p]);
        if (here == call.words[p]) return false;
        call.words[p] = here;
      } else if (parameter.type == ValueType::address) {
        return false;
      } else if (parameter.object != ObjectKind::none) {
        call.words[p] = names(parameter.object).here(parameter.object, call.words[p]);
      }
    } else if (parameter.object != ObjectKind::none && parameter.input && call.words[p] != 0 &&
               value_size(parameter.type) == sizeof(GLuint)) {
      const std::size_t count = call.bytes[p] / sizeof(GLuint);
      auto* here = reinterpret_cast<GLuint*>(scratch(call.bytes[p]));
      const auto* there = reinterpret_cast<const GLuint*>(address(call.words[p]));
      for (std::size_t i = 0; i < count; ++i)
        here[i] = GLuint(names(parameter.object).here(parameter.object, there[i]));
      call.words[p] = word_of(here);
    } else if (call.kinds[p] == ReferenceKind::address &&
               (parameter.rule == ExtentRule::address || parameter.rule == ExtentRule::unknown)) {
      return false;
    }
  }
  const std::string_view name = call_name(call.id);
  const std::uint8_t location = argument_named(*call.shape, "location");
  if (location != no_argument && (name.starts_with("glUniform") || name.starts_with("glProgramUniform"))) {
    const std::uint64_t program =
        name.starts_with("glProgramUniform") ? call.words[0] : own_names_.current_program;
    call.words[location] = std::uint64_t(
        std::int64_t(names(ObjectKind::program).location_here(program, std::int32_t(call.words[location]))));
  }
  if (call.id == CallId::UseProgram || call.id == CallId::UseProgramObjectARB)
    own_names_.current_program = call.words[0];
  return true;
}

/// Answers of a stream from elsewhere are written to memory of ours.
std::string Decoder::provide_outputs(Call& call, const DispatchTable& gl) {
  const auto parameters = call.shape->parameters();
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const ParameterShape& parameter = parameters[p];
    if (parameter.pointer == 0 || parameter.input) continue;
    // No driver looks whether there is a place for pixels.
    if (call.kinds[p] == ReferenceKind::null && parameter.rule == ExtentRule::image_out) call.skip = true;
    if (call.words[p] == 0) continue;
    if (call.kinds[p] == ReferenceKind::address && parameter.rule == ExtentRule::image_out)
      continue;  // an offset
    if (call.kinds[p] != ReferenceKind::output)
      return in_call(call.id, fmt::format("{} is no place for an answer", parameter.name()));
    std::size_t bytes = pointee_bytes(call.id, p, call.words.data()).value_or(unknown_output_bytes);
    const bool linked = origin_ == StreamOrigin::linked;
    if (parameter.rule == ExtentRule::image_out) {
      if (linked) return provide_image(call, p, gl);
      if (call.id != CallId::ReadPixels) {
        call.skip = true;
        return {};
      }
      const ImageShape shape = image_shape(call.id, call.words.data());
      const auto extent = begin_and_end_.inside() ? std::nullopt : image_extent(shape, tight_pixels);
      if (!extent || *extent > most_output_bytes) {
        call.skip = true;
        return {};
      }
      read_image_.shape = shape;
      read_image_.pixels.assign(*extent, std::byte(0));
      call.words[p] = word_of(read_image_.pixels.data());
      // Where the sender wanted it does not matter here: it is read as images lie in streams.
      const PixelStore store = pixel_store(gl, pack_names);
      set_pixel_store(gl, pack_names, store, tight_pixels);
      invoke(gl, call.id, call.words.data());
      set_pixel_store(gl, pack_names, tight_pixels, store);
      call.skip = true;
      return {};
    }
    if (bytes > (linked ? most_linked_output_bytes : most_output_bytes))
      return in_call(call.id, "claims an answer beyond all reason");
    call.bytes[p] = bytes;
    if (parameter.rule == ExtentRule::retained) {
      retained_.emplace_back(words_for(std::max<std::size_t>(bytes, 8)));
      call.words[p] = word_of(retained_.back().data());
      (call.id == CallId::SelectBuffer ? selection_ : feedback_) = retained_.size();
    } else {
      std::uint64_t* const memory = scratch(std::max<std::size_t>(bytes, 8));
      if (linked) std::memset(memory, std::to_integer<int>(unwritten), std::max<std::size_t>(bytes, 8));
      call.words[p] = word_of(memory);
    }
  }
  return {};
}

/// No draw of a stream from elsewhere reads memory that the stream did not bring.
std::string Decoder::check_arrays(Call& call, const DispatchTable& gl) {
  const auto parameters = call.shape->parameters();
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (parameters[p].rule == ExtentRule::client_array && call.words[p] != 0 && !begin_and_end_.inside() &&
        ask(gl, GL_ARRAY_BUFFER_BINDING) == 0) {
      call.words[p] = 0;
    }
    // Offsets mean something only while a buffer is bound.
    const bool offset = call.kinds[p] == ReferenceKind::address && call.words[p] != 0;
    const ExtentRule rule = parameters[p].rule;
    const GLenum binding =
        rule == ExtentRule::indices || rule == ExtentRule::index_lists       ? GL_ELEMENT_ARRAY_BUFFER_BINDING
        : rule == ExtentRule::indirect                                       ? GL_DRAW_INDIRECT_BUFFER_BINDING
        : rule == ExtentRule::image || rule == ExtentRule::counted_or_unpack ? GL_PIXEL_UNPACK_BUFFER_BINDING
        : rule == ExtentRule::image_out                                      ? GL_PIXEL_PACK_BUFFER_BINDING
                                                                             : GL_NONE;
    if (offset && binding != GL_NONE && (begin_and_end_.inside() || ask(gl, binding) == 0))
      return in_call(call.id, fmt::format("{} is an offset, but no buffer is bound", parameters[p].name()));
    if (offset && rule == ExtentRule::index_lists) call.skip = true;
  }
  if (call.id == CallId::EnableClientState || call.id == CallId::EnableVertexAttribArray ||
      call.id == CallId::EnableVertexAttribArrayARB || call.id == CallId::InterleavedArrays ||
      call.id == CallId::EnableVertexArrayAttrib || call.id == CallId::EnableClientStateIndexedEXT ||
      call.id == CallId::PopClientAttrib) {
    client_memory_ = true;
  }
  if (!client_memory_ || !draws_arrays(call.id)) return {};
  if (begin_and_end_.inside()) {
    const auto range = element_range(gl, call.id, call.words.data());
    if (!range || range->first < arrays_range_.first || range->last > arrays_range_.last) call.skip = true;
    return {};
  }
  const std::vector<ClientArray> used = client_arrays(gl);
  if (used.empty()) return {};
  const auto range = element_range(gl, call.id, call.words.data());
  const bool brought =
      arrays_active_ && range && !range->empty() && range->first >= arrays_range_.first &&
      range->last <= arrays_range_.last && range->first_instance >= arrays_range_.first_instance &&
      range->last_instance <= arrays_range_.last_instance &&
      std::all_of(used.begin(), used.end(), [](const ClientArray& array) { return array.pointer != 0; });
  call.skip |= !brought;
  return {};
}

/// A mapping that ends must not be written to any more.
void Decoder::forget_mappings(const Call& call, const DispatchTable& gl) {
  ObjectNames& buffers = names(ObjectKind::buffer);
  if (!buffers.has_mappings()) return;
  void* pointer = nullptr;
  switch (call.id) {
    case CallId::UnmapBuffer:
    case CallId::UnmapBufferARB:
    case CallId::BufferData:
    case CallId::BufferDataARB:
    case CallId::BufferStorage:
      gl.GetBufferPointerv(GLenum(call.words[0]), GL_BUFFER_MAP_POINTER, &pointer);
      buffers.drop_mapping(pointer);
      break;
    case CallId::UnmapNamedBuffer:
    case CallId::UnmapNamedBufferEXT:
    case CallId::NamedBufferData:
    case CallId::NamedBufferDataEXT:
    case CallId::DeleteBuffers:
    case CallId::DeleteBuffersARB:
      // Rare, and the name may be nobody's: what else is mapped loses its later writes, never its safety.
      buffers.drop_all_mappings();
      break;
    default:
      break;
  }
}

void Decoder::remember_answer(const Call& call, std::uint64_t result, const DispatchTable& gl) {
  answer_ = {.call = call.id, .result = result};
  if (is_location_query(call.id)) answer_.program = call.words[0];
  if (maps_a_buffer(call.id) && result != 0)
    answer_.mapped_bytes = mapped_bytes(call.id, call.words.data(), gl);
  const auto parameters = call.shape->parameters();
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (!answers_names(parameters[p])) continue;
    const auto bytes = pointee_bytes(call.id, p, call.words.data());
    if (!bytes || call.words[p] == 0) continue;
    const auto* first = reinterpret_cast<const std::uint32_t*>(address(call.words[p]));
    answer_.names.emplace_back(first, first + *bytes / sizeof(std::uint32_t));
  }
}

Decoded Decoder::make(Call& call, const DispatchTable& gl) {
  if (slot(gl, call.id) == nullptr) return {0, in_call(call.id, "the driver here does not have it")};
  Decoded decoded;
  if (call.image_in && !begin_and_end_.inside()) {
    const PixelStore store = pixel_store(gl, unpack_names);
    set_pixel_store(gl, unpack_names, store, tight_pixels);
    decoded.result = invoke(gl, call.id, call.words.data());
    set_pixel_store(gl, unpack_names, tight_pixels, store);
  } else {
    decoded.result = invoke(gl, call.id, call.words.data());
  }
  begin_and_end_.follow(call.id, call.words.data());
  return decoded;
}

Decoded Decoder::begin_arrays(const Record& record, const DispatchTable& gl) {
  const auto arguments = record.arguments();
  const std::uint64_t count = arguments.empty() ? 0 : arguments[0];
  if (arguments.empty() || count > (arguments.size() - 1) / event::words_per_array)
    return {0, "vertex arrays: fewer than announced"};
  arrays_.clear();
  arrays_range_ = {};
  const GLint bound = ask(gl, GL_ARRAY_BUFFER_BINDING);
  if (bound != 0) gl.BindBuffer(GL_ARRAY_BUFFER, 0);
  std::string error;
  for (std::uint64_t i = 0; i < count && error.empty(); ++i) {
    const auto field = arguments.subspan(1 + i * event::words_per_array, event::words_per_array);
    const auto data = record.bytes(field[9]);
    ClientArray array{.role = ArrayRole(field[0]),
                      .index = GLuint(field[1]),
                      .size = GLint(field[2]),
                      .type = GLenum(field[3]),
                      .normalized = field[4] != 0,
                      .stride = GLsizei(field[5]),
                      .pointer = Reference::from(field[6]).value,
                      .divisor = GLuint(field[7])};
    const auto first = std::int64_t(field[8]);
    const std::size_t bytes = array.element_bytes();
    if (field[0] >= array_role_count || !data || first < 0 || first > std::int64_t(1) << 32) {
      error = "a vertex array leads out of the stream";
      break;
    }
    const std::int64_t elements = bytes == 0 ? 0 : std::int64_t(data->size() / bytes);
    const std::byte* copy = elements == 0 ? nullptr : data->data() - std::size_t(first) * bytes;
    point_array(gl, array, GLsizei(bytes), copy);
    arrays_.push_back(array);
    if (array.divisor == 0) {
      const bool sooner = arrays_range_.empty();
      arrays_range_.first = sooner ? first : std::max(arrays_range_.first, first);
      arrays_range_.last = sooner ? first + elements - 1 : std::min(arrays_range_.last, first + elements - 1);
    } else {
      arrays_range_.first_instance = first;
      arrays_range_.last_instance = std::max(arrays_range_.last_instance, first + elements * array.divisor - 1);
    }
  }
  if (bound != 0) gl.BindBuffer(GL_ARRAY_BUFFER, GLuint(bound));
  arrays_active_ = true;
  return {0, error};
}

void Decoder::end_arrays(const DispatchTable& gl) {
  if (!arrays_active_) return;
  arrays_active_ = false;
  const GLint bound = ask(gl, GL_ARRAY_BUFFER_BINDING);
  if (bound != 0) gl.BindBuffer(GL_ARRAY_BUFFER, 0);
  for (const ClientArray& array : arrays_) {
    const bool mine = origin_ == StreamOrigin::this_process;
    point_array(gl, array, array.stride, mine ? address(array.pointer) : nullptr);
  }
  if (bound != 0) gl.BindBuffer(GL_ARRAY_BUFFER, GLuint(bound));
}

Decoded Decoder::take_answers(const Record& record) {
  const auto arguments = record.arguments();
  if (arguments.size() < 2) return {0, "answers: too short"};
  if (find_stable_id(std::uint32_t(arguments[0])) != answer_.call) return {};
  const CallShape& shape = call_shape(answer_.call);
  if (shape.result_object != ObjectKind::none && answer_.result != 0)
    names(shape.result_object).set(shape.result_object, arguments[1], answer_.result);
  if (is_location_query(answer_.call)) {
    names(ObjectKind::program)
        .set_location(answer_.program, std::int32_t(arguments[1]), std::int32_t(answer_.result));
  }
  if (maps_a_buffer(answer_.call)) {
    names(ObjectKind::buffer)
        .set_mapping(arguments[1],
                     {reinterpret_cast<std::byte*>(std::uintptr_t(answer_.result)), answer_.mapped_bytes});
  }
  std::size_t at = 2;
  std::size_t output = 0;
  for (const ParameterShape& parameter : shape.parameters()) {
    if (!answers_names(parameter)) continue;
    if (at >= arguments.size() || output >= answer_.names.size()) break;
    const auto there = record.bytes(arguments[at++]);
    const auto& here = answer_.names[output++];
    if (!there) return {0, "answers lead out of the stream"};
    for (std::size_t i = 0; i < std::min(here.size(), there->size() / sizeof(std::uint32_t)); ++i) {
      std::uint32_t name = 0;
      std::memcpy(&name, there->data() + i * sizeof name, sizeof name);
      names(parameter.object).set(parameter.object, name, here[i]);
    }
  }
  return {};
}

Decoded Decoder::write_mapped(const Record& record) {
  const auto arguments = record.arguments();
  if (arguments.size() < 3) return {0, "write into a mapped buffer: too short"};
  const auto data = record.bytes(arguments[2]);
  const ObjectNames::Mapping mapping = names(ObjectKind::buffer).mapping(arguments[0]);
  if (!data) return {0, "write into a mapped buffer: the data lead out of the stream"};
  if (mapping.first == nullptr) return {};
  if (arguments[1] > mapping.bytes || data->size() > mapping.bytes - arguments[1])
    return {0, "write into a mapped buffer: beyond its end"};
  std::memcpy(mapping.first + arguments[1], data->data(), data->size());
  return {};
}

Decoded Decoder::decode(const Record& record, const DispatchTable& gl) {
  scratch_used_ = 0;
  if (!read_image_.pixels.empty()) read_image_.pixels.clear();
  call_answer_ = {};
  if (record.id == event::arrays) return begin_arrays(record, gl);
  if (record.id == event::arrays_end) {
    end_arrays(gl);
    return {};
  }
  if (record.id == event::answers) return take_answers(record);
  if (record.id == event::mapped_write) return write_mapped(record);
  Call call;
  if (std::string error = read_arguments(record, call); !error.empty()) return {0, std::move(error)};
  if (origin_ == StreamOrigin::this_process) return make(call, gl);
  answer_ = {};
  const bool linked = origin_ == StreamOrigin::linked;
  if ((!linked && only_asks(call.id) && !answers_into_buffer(call)) || !translate(call)) return {};
  if (std::string error = check_arrays(call, gl); !error.empty()) return {0, std::move(error)};
  if (call.skip) return {};
  if (slot(gl, call.id) == nullptr) return {0, in_call(call.id, "the driver here does not have it")};
  if (std::string error = provide_outputs(call, gl); !error.empty()) return {0, std::move(error)};
  if (call.skip) return {};
  forget_mappings(call, gl);
  if (linked) return make_and_answer(call, gl);
  Decoded decoded = make(call, gl);
  if (decoded.error.empty() && names_something(call.id)) remember_answer(call, decoded.result, gl);
  return decoded;
}

}  // namespace understudy::spu
