// SPDX-License-Identifier: Apache-2.0
// The part of the decoder that provides memory for the answers of calls in a stream from elsewhere.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <string_view>

#include "dispatch/call_words.h"
#include "spu/stream/bound_buffers.h"
#include "spu/stream/decode.h"
#include "spu/stream/decoded_call.h"
#include "spu/stream/extent.h"
#include "spu/stream/mapping_calls.h"
#include "spu/stream/pointer_words.h"
#include "spu/stream/unknown_answers.h"

namespace understudy::spu {
namespace {

/// Drivers write a whole value, even if the caller has room for none.
constexpr std::size_t least_output_bytes = 8;

/// Limit for feedback or selection buffers that the driver may still use.
constexpr std::size_t most_retained = 4;

/// Whether the answer can be as long as a buffer object.
bool reads_buffer(CallId call) {
  return std::string_view(call_name(call)).find("BufferSubData") != std::string_view::npos;
}

std::size_t bytes_of_buffer(CallId call, const std::uint64_t* words, const DispatchTable& gl) {
  GLint64 bytes = 0;
  if (!is_by_name(call)) {
    bytes = GLint64(bound_bytes(gl, GLenum(words[0])));
  } else if (gl.GetNamedBufferParameteri64v != nullptr) {
    gl.GetNamedBufferParameteri64v(GLuint(words[0]), GL_BUFFER_SIZE, &bytes);
  }
  return std::min(std::size_t(std::max<GLint64>(bytes, 0)), most_linked_output_bytes);
}

}  // namespace

/// Executes glReadPixels of a recorded stream. Where the sender stored the pixels does not matter: they are
/// read in the layout of streams.
void Decoder::read_image(Call& call, std::size_t p, const DispatchTable& gl) {
  call.skip = true;
  if (call.id != CallId::ReadPixels) return;
  const ImageShape shape = image_shape(call.id, call.words.data());
  const auto extent = image_extent(shape, tight_pixels);
  if (!extent || *extent > most_output_bytes) return;
  read_image_.shape = shape;
  read_image_.pixels.assign(*extent, std::byte(0));
  std::byte nothing[least_output_bytes];
  call.words[p] = word_of(read_image_.pixels.empty() ? nothing : read_image_.pixels.data());
  const PixelStore store = pixel_store(gl, pack_names);
  set_pixel_store(gl, pack_names, store, tight_pixels);
  invoke(gl, call.id, call.words.data());
  set_pixel_store(gl, pack_names, tight_pixels, store);
}

std::string Decoder::provide_output(Call& call, std::size_t p, const DispatchTable& gl) {
  const ParameterShape& parameter = call.shape->parameters()[p];
  const bool linked = origin_ == StreamOrigin::linked;
  if (parameter.rule == ExtentRule::image_out) {
    if (call.kinds[p] != ReferenceKind::output) return {};  // an offset
    if (linked) return provide_image(call, p, gl);
    read_image(call, p, gl);
    return {};
  }
  auto bytes = pointee_bytes(call.id, p, call.words.data());
  if (!bytes && parameter.rule == ExtentRule::unknown) bytes = room_for_answer(call.id, call.words.data(), gl);
  const bool buffer = linked && reads_buffer(call.id);
  if (!bytes || *bytes > (buffer ? bytes_of_buffer(call.id, call.words.data(), gl) : most_output_bytes))
    return in_call(call.id, "claims an answer beyond all reason");
  call.bytes[p] = *bytes;
  const std::size_t room = std::max(*bytes, least_output_bytes);
  if (parameter.rule == ExtentRule::retained) {
    auto& retained = call.id == CallId::SelectBuffer ? selection_ : feedback_;
    if (retained.size() > most_retained) return in_call(call.id, "the driver keeps too many such buffers");
    call.words[p] = word_of(retained.emplace_back(words_for(room)).data());
    return {};
  }
  std::uint64_t* const memory = scratch(room);
  if (linked) std::memset(memory, std::to_integer<int>(unwritten), room);
  call.words[p] = word_of(memory);
  return {};
}

std::string Decoder::provide_outputs(Call& call, const DispatchTable& gl) {
  const auto parameters = call.shape->parameters();
  for (std::size_t p = 0; p < parameters.size() && !call.skip; ++p) {
    if (parameters[p].pointer == 0 || parameters[p].input) continue;
    const bool null = call.kinds[p] == ReferenceKind::null;
    if (null && parameters[p].null_with == p) continue;
    // Drivers do not check whether the pointer for pixels is null.
    if (null && parameters[p].rule == ExtentRule::image_out && !call.into_buffer) call.skip = true;
    if (call.skip) continue;
    if (std::string error = provide_output(call, p, gl); !error.empty()) return error;
  }
  return {};
}

/// Frees buffers that the driver no longer uses. It keeps one of each kind: the last one that it accepted.
void Decoder::forget_retained(CallId call, const DispatchTable& gl) {
  if (call != CallId::FeedbackBuffer && call != CallId::SelectBuffer) return;
  const bool feedback = call == CallId::FeedbackBuffer;
  auto& retained = feedback ? feedback_ : selection_;
  void* used = nullptr;
  gl.GetPointerv(feedback ? GL_FEEDBACK_BUFFER_POINTER : GL_SELECTION_BUFFER_POINTER, &used);
  const bool ours =
      std::any_of(retained.begin(), retained.end(), [&](const auto& buffer) { return buffer.data() == used; });
  if (ours) std::erase_if(retained, [&](const auto& buffer) { return buffer.data() != used; });
}

}  // namespace understudy::spu
