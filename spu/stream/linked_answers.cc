// SPDX-License-Identifier: Apache-2.0
// The part of the decoder for linked streams: queries are made, and answers are kept for the sender.
#include <algorithm>
#include <cstring>
#include <string_view>

#include "dispatch/call_words.h"
#include "spu/stream/answers.h"
#include "spu/stream/decode.h"
#include "spu/stream/decoded_call.h"
#include "spu/stream/extent.h"
#include "spu/stream/image_answers.h"
#include "spu/stream/mapping_calls.h"
#include "spu/stream/pointer_words.h"

namespace understudy::spu {
namespace {

/// Bytes of a mapped buffer that the application does not write stay unchanged, so the sender needs the
/// contents, unless the call discards them.
bool contents_matter(CallId call, const std::uint64_t* words) {
  const std::uint8_t access_at = argument_named(call_shape(call), "access");
  if (access_at == no_argument || argument_named(call_shape(call), "length") == no_argument) return true;
  constexpr GLbitfield discarded = GL_MAP_INVALIDATE_RANGE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT;
  return (GLbitfield(words[access_at]) & discarded) == 0;
}

/// The contents of the range that the call will map. Empty if the call is going to fail.
std::vector<std::byte> contents_before(CallId call, const std::uint64_t* words, const DispatchTable& gl) {
  const bool named = is_by_name(call);
  GLint size = 0;
  GLint mapped = 0;
  if (named) {
    gl.GetNamedBufferParameteriv(GLuint(words[0]), GL_BUFFER_SIZE, &size);
    gl.GetNamedBufferParameteriv(GLuint(words[0]), GL_BUFFER_MAPPED, &mapped);
  } else {
    gl.GetBufferParameteriv(GLenum(words[0]), GL_BUFFER_SIZE, &size);
    gl.GetBufferParameteriv(GLenum(words[0]), GL_BUFFER_MAPPED, &mapped);
  }
  const std::uint8_t length_at = argument_named(call_shape(call), "length");
  const std::uint64_t offset = length_at == no_argument ? 0 : words[argument_named(call_shape(call), "offset")];
  const std::uint64_t length = length_at == no_argument ? std::uint64_t(std::max(size, 0)) : words[length_at];
  if (size <= 0 || mapped != 0 || length == 0 || offset > std::uint64_t(size) ||
      length > std::uint64_t(size) - offset) {
    return {};
  }
  std::vector<std::byte> contents(length);
  if (named) {
    gl.GetNamedBufferSubData(GLuint(words[0]), GLintptr(offset), GLsizeiptr(length), contents.data());
  } else {
    gl.GetBufferSubData(GLenum(words[0]), GLintptr(offset), GLsizeiptr(length), contents.data());
  }
  return contents;
}

}  // namespace

std::string Decoder::provide_image(Call& call, std::size_t p, const DispatchTable& gl) {
  call.skip = true;
  const auto image = image_answer(call.id, call.words.data(), gl);
  if (!image) return {};
  if (image->bytes > most_linked_output_bytes)
    return std::string(call_name(call.id)) + ": claims an answer beyond all reason";
  AnsweredOutput output{
      .parameter = std::uint32_t(p), .image = image->shape, .bytes = std::vector<std::byte>(image->bytes)};
  // OpenGL needs a valid address even for an empty image, and may write a whole word there.
  std::byte nothing[8];
  call.words[p] = reinterpret_cast<std::uintptr_t>(output.bytes.empty() ? nothing : output.bytes.data());
  const PixelStore store = pixel_store(gl, pack_names);
  set_pixel_store(gl, pack_names, store, tight_pixels);
  invoke(gl, call.id, call.words.data());
  set_pixel_store(gl, pack_names, tight_pixels, store);
  call_answer_.outputs.push_back(std::move(output));
  return {};
}

/// Whether a returned pointer may be an address in this process instead of an offset that the sender has set.
bool Decoder::tells_address_of_ours(const Call& call) const {
  if (arrays_.active()) return true;
  const std::string_view name = call_name(call.id);
  if (name.find("VertexA") != std::string_view::npos) return false;
  const auto what = GLenum(call.words[0]);
  const bool array = what >= GL_VERTEX_ARRAY_POINTER && what <= GL_EDGE_FLAG_ARRAY_POINTER;
  const bool later_array = what == GL_FOG_COORD_ARRAY_POINTER || what == GL_SECONDARY_COLOR_ARRAY_POINTER;
  return !name.starts_with("glGetPointer") || !(array || later_array);
}

void Decoder::answer_outputs(const Call& call) {
  const auto parameters = call.shape->parameters();
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const ParameterShape& parameter = parameters[p];
    if (parameter.pointer == 0 || parameter.input || call.words[p] == 0 ||
        call.kinds[p] != ReferenceKind::output || parameter.rule == ExtentRule::retained) {
      continue;
    }
    const std::byte* first = address_in(call.words[p]);
    std::size_t bytes = call.bytes[p];
    while (bytes > 0 && first[bytes - 1] == unwritten) --bytes;
    if (bytes == 0) continue;
    if (parameter.pointer > 1 && tells_address_of_ours(call)) continue;
    // Rounded up to whole values. Untyped data may end with bytes equal to `unwritten`, so all of it is taken.
    const std::size_t value = parameter.pointer > 1 ? sizeof(void*) : value_size(parameter.type);
    // (If the call does not determine its size, it is the text of a program.)
    if (parameter.type == ValueType::untyped && pointee_bytes(call.id, p, call.words.data())) {
      bytes = call.bytes[p];
    } else {
      bytes = std::min((bytes + value - 1) / value * value, call.bytes[p]);
    }
    call_answer_.outputs.push_back({std::uint32_t(p), std::nullopt, {first, first + bytes}});
  }
}

void Decoder::answer_result(const Call& call, std::uint64_t result) {
  call_answer_.result = result;
  if (call.shape->result_object == ObjectKind::sync) {
    if (result == 0) return;
    call_answer_.result = names(ObjectKind::sync).new_sync_name();
    names(ObjectKind::sync).set(ObjectKind::sync, call_answer_.result, result);
    return;
  }
  if (call.shape->result_pointer == 0 || result == 0) return;
  if (call.shape->result == ValueType::uint8) {
    const char* text = reinterpret_cast<const char*>(address_in(result));
    const std::byte* first = address_in(result);
    call_answer_.outputs.push_back(
        {AnsweredOutput::result_text, std::nullopt, {first, first + std::strlen(text) + 1}});
  } else if (!maps_a_buffer(call.id)) {
    call_answer_.result = 0;  // an address of this process
  }
}

/// Adds what OpenGL has written into the application's feedback or selection buffer in the meantime.
void Decoder::answer_feedback(const Call& call, GLint mode, const DispatchTable& gl) {
  if (call.id != CallId::RenderMode || (mode != GL_FEEDBACK && mode != GL_SELECT)) return;
  const bool feedback = mode == GL_FEEDBACK;
  void* used = nullptr;
  gl.GetPointerv(feedback ? GL_FEEDBACK_BUFFER_POINTER : GL_SELECTION_BUFFER_POINTER, &used);
  for (const std::vector<std::uint64_t>& buffer : feedback ? feedback_ : selection_) {
    if (buffer.data() != used) continue;
    const auto* first = reinterpret_cast<const std::byte*>(buffer.data());
    call_answer_.outputs.push_back(
        {AnsweredOutput::feedback, std::nullopt, {first, first + buffer.size() * sizeof(std::uint64_t)}});
  }
}

Decoded Decoder::make_and_answer(Call& call, const DispatchTable& gl) {
  GLint mode = GL_RENDER;
  if (call.id == CallId::RenderMode) gl.GetIntegerv(GL_RENDER_MODE, &mode);
  std::vector<std::byte> contents;
  const bool maps = maps_a_buffer(call.id) && !begin_and_end_.inside();
  if (maps && contents_matter(call.id, call.words.data()))
    contents = contents_before(call.id, call.words.data(), gl);
  Decoded decoded = make(call, gl);
  if (!decoded.error.empty()) return decoded;
  answer_outputs(call);
  answer_result(call, decoded.result);
  answer_feedback(call, mode, gl);
  if (maps && decoded.result != 0) {
    remember_answer(call, decoded.result, gl);
    call_answer_.outputs.push_back({AnsweredOutput::mapped, std::nullopt, std::move(contents)});
    // Tells the sender how many bytes to map, with or without contents.
    call_answer_.result = answer_.mapped.bytes;
  }
  return decoded;
}

}  // namespace understudy::spu
