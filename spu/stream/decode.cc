// SPDX-License-Identifier: Apache-2.0
#include "spu/stream/decode.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <span>
#include <string_view>

#include "dispatch/call_words.h"
#include "spu/stream/answers.h"
#include "spu/stream/bound_buffers.h"
#include "spu/stream/checked_pointers.h"
#include "spu/stream/decoded_call.h"
#include "spu/stream/event.h"
#include "spu/stream/extent.h"
#include "spu/stream/mapping_calls.h"
#include "spu/stream/pointer_words.h"

namespace understudy::spu {
namespace {

/// Whether the call only queries: a stream from elsewhere contains the answer already.
bool only_asks(CallId call) {
  const std::string_view name = call_name(call);
  if (name.starts_with("glGetUniformLocation")) return false;
  return name.starts_with("glGet") || name.starts_with("glIs") || name.starts_with("glAre");
}

/// Whether contexts of a share group share objects of this kind.
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

/// Size in bytes of the mapping that the call has just created.
std::size_t mapped_bytes(CallId call, const std::uint64_t* words, const DispatchTable& gl) {
  const std::uint8_t length = argument_named(call_shape(call), "length");
  if (length != no_argument) return words[length];
  GLint64 size = 0;
  if (is_by_name(call)) {
    gl.GetNamedBufferParameteri64v(GLuint(words[0]), GL_BUFFER_SIZE, &size);
  } else {
    gl.GetBufferParameteri64v(GLenum(words[0]), GL_BUFFER_SIZE, &size);
  }
  return std::size_t(std::max<GLint64>(size, 0));
}

/// Whether the driver still has the mapping, and allows writing to it.
bool is_mapped(const ObjectNames::Mapping& mapping, const DispatchTable& gl) {
  const BufferMapping now = mapping_of(gl, mapping.buffer);
  return now.first == mapping.first && now.access != GL_READ_ONLY;
}

/// While in scope, glPixelStore parameters match the layout of images in streams.
class TightPixels {
 public:
  TightPixels(const DispatchTable& gl, const std::array<GLenum, 8>& names, bool wanted)
      : gl_(gl), names_(names), wanted_(wanted) {
    if (!wanted_) return;
    store_ = pixel_store(gl, names);
    set_pixel_store(gl, names, store_, tight_pixels);
  }
  ~TightPixels() {
    if (wanted_) set_pixel_store(gl_, names_, tight_pixels, store_);
  }
  TightPixels(const TightPixels&) = delete;
  TightPixels& operator=(const TightPixels&) = delete;

 private:
  const DispatchTable& gl_;
  const std::array<GLenum, 8>& names_;
  const bool wanted_;
  PixelStore store_;
};

}  // namespace

std::string in_call(CallId call, std::string_view what) {
  return fmt::format("{}: {}", call_name(call), what);
}

/// Whether the answer goes to a bound buffer object, where later calls may use it.
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
    lengths = reinterpret_cast<const GLint*>(address_in(call.words[lengths_at]));
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
  const auto* counts = reinterpret_cast<const GLsizei*>(address_in(call.words[counts_at]));
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

std::string Decoder::read_references(const Record& record, Call& call) {
  const auto parameters = call.shape->parameters();
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    call.words[p] = record.words[p + 1];
    if (parameters[p].pointer == 0) continue;
    const Reference reference = Reference::from(record.words[p + 1]);
    call.kinds[p] = reference.kind;
    call.words[p] = reference.kind == ReferenceKind::null ? 0 : reference.value;
    if (reference.kind > ReferenceKind::lists)
      return in_call(call.id, fmt::format("{} is no reference", parameters[p].name()));
    if (!believes() && !may_be(parameters[p], reference.kind))
      return in_call(
          call.id, fmt::format("{} is {}", parameters[p].name(), refused_kind(parameters[p], reference.kind)));
    if (reference.kind == ReferenceKind::inside || reference.kind == ReferenceKind::payload) {
      if (std::string error = read_bytes(record, call, p); !error.empty()) return error;
    }
  }
  return {};
}

/// Strings and lists are read last, because their sizes depend on other arguments.
std::string Decoder::read_lists_of(const Record& record, Call& call) {
  for (std::size_t p = 0; p < call.shape->parameter_count; ++p) {
    std::string error;
    if (call.kinds[p] == ReferenceKind::strings) error = read_strings(record, call, p);
    if (call.kinds[p] == ReferenceKind::lists) error = read_lists(record, call, p);
    if (!error.empty()) return error;
  }
  return {};
}

/// Checks that the stream contains as many bytes as the call reads.
std::string Decoder::measure(Call& call, std::size_t p) {
  const ParameterShape& parameter = call.shape->parameters()[p];
  if (call.kinds[p] == ReferenceKind::null && !believes()) return refuse_null(call, p);
  if (call.kinds[p] != ReferenceKind::inside && call.kinds[p] != ReferenceKind::payload) return {};
  const bool text = parameter.rule == ExtentRule::text || (parameter.rule == ExtentRule::text_or_counted &&
                                                           std::int32_t(call.words[parameter.counted_by]) < 0);
  if (text) {
    if (std::memchr(address_in(call.words[p]), 0, call.bytes[p]) == nullptr)
      return in_call(call.id, fmt::format("{} does not end", parameter.name()));
    return {};
  }
  const auto needed = parameter.rule == ExtentRule::image
                          ? image_extent(image_shape(call.id, call.words.data()), tight_pixels)
                          : pointee_bytes(call.id, p, call.words.data());
  if (!needed || *needed > call.bytes[p]) {
    return in_call(call.id, fmt::format("{} needs {} bytes and has {}", parameter.name(),
                                        needed ? std::to_string(*needed) : "unknown", call.bytes[p]));
  }
  call.tight_unpack |=
      parameter.rule == ExtentRule::image || (!believes() && parameter.rule == ExtentRule::counted_or_unpack);
  if (!believes()) give_room(call, p);
  return {};
}

std::string Decoder::read_arguments(const Record& record, Call& call) {
  const auto found = find_stable_id(record.id);
  if (!found) return fmt::format("call id {:#010x} is not in this registry", record.id);
  call.id = *found;
  call.shape = &call_shape(call.id);
  const std::size_t parameters = call.shape->parameter_count;
  if (record.words.size() < parameters + 1)
    return in_call(call.id, fmt::format("has {} arguments here, not {}", parameters, record.words.size() - 1));
  if (std::string error = read_references(record, call); !error.empty()) return error;
  if (std::string error = read_lists_of(record, call); !error.empty()) return error;
  for (std::size_t p = 0; p < parameters; ++p) {
    if (std::string error = measure(call, p); !error.empty()) return error;
  }
  return {};
}

std::string Decoder::read(const Record& record, ReadCall& to) {
  scratch_used_ = 0;
  Call call;
  std::string error = read_arguments(record, call);
  to.id = call.id;
  to.words = call.words;
  to.kinds = call.kinds;
  return error;
}

/// Translates the sender's names of objects to ours. Returns false if the call has no meaning here.
bool Decoder::translate(Call& call) {
  const auto parameters = call.shape->parameters();
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const ParameterShape& parameter = parameters[p];
    if (parameter.pointer == 0) {
      if (parameter.object == ObjectKind::sync) {
        const std::uint64_t here = names(parameter.object).here(parameter.object, call.words[p]);
        if (here == call.words[p]) return false;
        if (call.id == CallId::DeleteSync) names(parameter.object).forget(parameter.object, call.words[p]);
        call.words[p] = here;
      } else if (parameter.type == ValueType::address || parameter.rule == ExtentRule::address) {
        return false;
      } else if (parameter.object != ObjectKind::none) {
        call.words[p] = names(parameter.object).here(parameter.object, call.words[p]);
      }
    } else if (parameter.object != ObjectKind::none && parameter.input && call.words[p] != 0 &&
               value_size(parameter.type) == sizeof(GLuint)) {
      const std::size_t count = call.bytes[p] / sizeof(GLuint);
      auto* here = reinterpret_cast<GLuint*>(scratch(call.bytes[p]));
      const auto* there = reinterpret_cast<const GLuint*>(address_in(call.words[p]));
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

/// Drops mappings that the call ends, so that they are not written to any more.
void Decoder::forget_mappings(const Call& call, const DispatchTable& gl) {
  ObjectNames& buffers = names(ObjectKind::buffer);
  if (!buffers.has_mappings()) return;
  if (deletes_buffers(call.id)) {
    for (const GLuint buffer : deleted_buffers(call.words.data())) buffers.drop_mapping(buffer);
  } else if (unmaps_buffer(call.id) || replaces_storage(call.id)) {
    buffers.drop_mapping(buffer_of(gl, call.id, call.words.data()));
  }
}

void Decoder::remember_answer(const Call& call, std::uint64_t result, const DispatchTable& gl) {
  answer_ = {.call = call.id, .result = result};
  if (is_location_query(call.id)) answer_.program = call.words[0];
  if (maps_a_buffer(call.id) && result != 0)
    answer_.mapped = {reinterpret_cast<std::byte*>(std::uintptr_t(result)),
                      mapped_bytes(call.id, call.words.data(), gl), buffer_of(gl, call.id, call.words.data())};
  const auto parameters = call.shape->parameters();
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (!answers_names(parameters[p])) continue;
    const auto bytes = pointee_bytes(call.id, p, call.words.data());
    if (!bytes || call.words[p] == 0) continue;
    const auto* first = reinterpret_cast<const std::uint32_t*>(address_in(call.words[p]));
    answer_.names.emplace_back(first, first + *bytes / sizeof(std::uint32_t));
  }
}

Decoded Decoder::make(Call& call, const DispatchTable& gl) {
  if (slot(gl, call.id) == nullptr) return {0, in_call(call.id, "the driver here does not have it")};
  const TightPixels unpacked(gl, unpack_names, call.tight_unpack);
  const TightPixels packed(gl, pack_names, call.tight_pack);
  Decoded decoded{invoke(gl, call.id, call.words.data()), {}};
  begin_and_end_.follow(call.id, call.words.data());
  return decoded;
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
    names(ObjectKind::buffer).set_mapping(arguments[1], answer_.mapped);
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

Decoded Decoder::write_mapped(const Record& record, const DispatchTable& gl) {
  const auto arguments = record.arguments();
  if (arguments.size() < 3) return {0, "write into a mapped buffer: too short"};
  const auto data = record.bytes(arguments[2]);
  const ObjectNames::Mapping mapping = names(ObjectKind::buffer).mapping(arguments[0]);
  if (!data) return {0, "write into a mapped buffer: the data lead out of the stream"};
  if (mapping.first == nullptr || !is_mapped(mapping, gl)) return {};
  if (arguments[1] > mapping.bytes || data->size() > mapping.bytes - arguments[1])
    return {0, "write into a mapped buffer: beyond its end"};
  std::memcpy(mapping.first + arguments[1], data->data(), data->size());
  return {};
}

Decoded Decoder::decode_event(const Record& record, const DispatchTable& gl) {
  if (record.id == event::arrays) return {0, arrays_.begin(record, gl, !believes())};
  if (record.id == event::answers) return take_answers(record);
  if (record.id == event::mapped_write) return write_mapped(record, gl);
  arrays_.end(gl, believes());
  return {};
}

/// Makes a call of a stream from elsewhere.
Decoded Decoder::decode_unbelieved(Call& call, const DispatchTable& gl) {
  answer_ = {};
  const bool linked = origin_ == StreamOrigin::linked;
  if ((!linked && only_asks(call.id) && !answers_into_buffer(call)) || !translate(call)) return {};
  if (slot(gl, call.id) == nullptr) return {0, in_call(call.id, "the driver here does not have it")};
  if (std::string error = check_pointers(call, gl); !error.empty()) return {0, std::move(error)};
  if (call.skip) return {};
  if (std::string error = arrays_.check(call.id, call.words.data(), begin_and_end_.inside(), gl, call.skip);
      !error.empty())
    return {0, in_call(call.id, error)};
  if (call.skip) return {};
  if (std::string error = provide_outputs(call, gl); !error.empty()) return {0, std::move(error)};
  if (call.skip) return {};
  forget_mappings(call, gl);
  Decoded decoded = linked ? make_and_answer(call, gl) : make(call, gl);
  forget_retained(call.id, gl);
  if (!linked && decoded.error.empty() && names_something(call.id)) remember_answer(call, decoded.result, gl);
  return decoded;
}

Decoded Decoder::decode(const Record& record, const DispatchTable& gl) {
  scratch_used_ = 0;
  if (!read_image_.pixels.empty()) read_image_.pixels.clear();
  call_answer_ = {};
  if (record.id == event::arrays || record.id == event::arrays_end || record.id == event::answers ||
      record.id == event::mapped_write) {
    return decode_event(record, gl);
  }
  Call call;
  if (std::string error = read_arguments(record, call); !error.empty()) return {0, std::move(error)};
  return believes() ? make(call, gl) : decode_unbelieved(call, gl);
}

}  // namespace understudy::spu
