// SPDX-License-Identifier: Apache-2.0
// The part of the decoder that checks pointers of a stream from elsewhere.
#include "spu/stream/checked_pointers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "spu/stream/bound_buffers.h"
#include "spu/stream/decode.h"
#include "spu/stream/decoded_call.h"
#include "spu/stream/extent.h"
#include "spu/stream/image_answers.h"
#include "spu/stream/pointer_words.h"

namespace understudy::spu {
namespace {

/// Size of OpenGL's longest parameter vector, a matrix of doubles.
constexpr std::size_t longest_parameter_bytes = 128;

bool is_bytes(ReferenceKind kind) {
  return kind == ReferenceKind::inside || kind == ReferenceKind::payload;
}

/// Bytes that the call reads or writes at an offset into a buffer; nothing if unknown.
std::optional<std::size_t> bytes_in_buffer(CallId call, std::size_t p, const std::uint64_t* words,
                                           const DispatchTable& gl) {
  switch (call_shape(call).parameters()[p].rule) {
    case ExtentRule::image:
      return image_extent(image_shape(call, words), pixel_store(gl, unpack_names));
    case ExtentRule::image_out: {
      const auto image = image_answer(call, words, gl);
      if (!image) return std::nullopt;
      return image->shape ? image_extent(*image->shape, pixel_store(gl, pack_names)) : image->bytes;
    }
    default:
      return pointee_bytes(call, p, words);
  }
}

/// Whether OpenGL rejects a call of unknown extent with an error, and reads nothing.
bool driver_refuses(CallId call, std::size_t p, const std::uint64_t* words) {
  const ExtentRule rule = call_shape(call).parameters()[p].rule;
  if (rule != ExtentRule::image) return tells_by_enumerant(rule);
  // The extent of a huge image is unknown too, but a driver may read it: GL_UNPACK_ROW_LENGTH lets its rows
  // overlap.
  const ImageShape image = image_shape(call, words);
  return !is_known_pixel(image.format, image.type);
}

}  // namespace

bool may_be(const ParameterShape& parameter, ReferenceKind kind) noexcept {
  if (kind == ReferenceKind::null) return true;
  const bool address = kind == ReferenceKind::address;
  if (!parameter.input) {
    if (parameter.rule == ExtentRule::image_out && address) return true;
    return kind == ReferenceKind::output;
  }
  switch (parameter.rule) {
    case ExtentRule::image:
    case ExtentRule::counted_or_unpack:
    case ExtentRule::indices:
    case ExtentRule::indirect:
      return address || is_bytes(kind);
    case ExtentRule::client_array:
      return address;
    case ExtentRule::index_lists:
      return address || kind == ReferenceKind::lists;
    case ExtentRule::texts:
      return kind == ReferenceKind::strings;
    case ExtentRule::address:
    case ExtentRule::unknown:
      // Has no translation: the call is skipped.
      return address;
    default:
      return parameter.pointer == 1 && is_bytes(kind);
  }
}

std::string_view refused_kind(const ParameterShape& parameter, ReferenceKind kind) noexcept {
  switch (kind) {
    case ReferenceKind::address:
      return "an address of another process";
    case ReferenceKind::output:
      return parameter.input ? "a place for an answer, where the call reads" : "no place for an answer";
    default:
      return parameter.input ? "data of another kind than the call reads" : "no place for an answer";
  }
}

std::string Decoder::refuse_null(const Call& call, std::size_t p) {
  const ParameterShape& parameter = call.shape->parameters()[p];
  // These depend on bindings, or on information that only the sender's process had.
  if (parameter.pointer == 0 || !parameter.input || buffer_point(parameter.rule) ||
      parameter.rule == ExtentRule::address)
    return {};
  if (parameter.null_with != no_argument && call.words[parameter.null_with] == 0) return {};
  const auto needed = least_pointee_bytes(call.id, p, call.words.data());
  if (needed ? *needed == 0 : tells_by_enumerant(parameter.rule)) return {};
  return in_call(call.id, fmt::format("{} is a null pointer", parameter.name()));
}

/// Drivers may read beyond the given size: strings up to a zero, whatever their length argument, and parameters
/// whose names are unknown here. The argument is copied to a larger buffer of ours.
void Decoder::give_room(Call& call, std::size_t p) {
  const ParameterShape& parameter = call.shape->parameters()[p];
  const bool text = parameter.type == ValueType::character && parameter.pointer == 1;
  if (!text && parameter.rule != ExtentRule::parameter_values) return;
  const std::size_t room = text ? call.bytes[p] + 1 : std::max(call.bytes[p], longest_parameter_bytes);
  std::uint64_t* const copy = scratch(room);
  std::memcpy(copy, address_in(call.words[p]), call.bytes[p]);
  call.words[p] = reinterpret_cast<std::uintptr_t>(copy);
}

/// Checks a pointer that is an offset, since a buffer is bound.
std::string Decoder::check_offset(Call& call, std::size_t p, GLenum target, const DispatchTable& gl) {
  const ParameterShape& parameter = call.shape->parameters()[p];
  const auto wrong = [&](std::string_view what) {
    return in_call(call.id, fmt::format("{} {}", parameter.name(), what));
  };
  if (call.kinds[p] != ReferenceKind::null && call.kinds[p] != ReferenceKind::address)
    return wrong("is memory, but a buffer is bound");
  call.into_buffer |= parameter.rule == ExtentRule::image_out;
  // Vertex arrays may get their offset before their buffer has a size; drivers check what a draw reads.
  if (parameter.rule == ExtentRule::client_array) return {};
  if (parameter.rule == ExtentRule::index_lists) {
    // The list of offsets is in the sender's memory.
    call.skip = true;
    return {};
  }
  const auto needed = bytes_in_buffer(call.id, p, call.words.data(), gl);
  const std::uint64_t bytes = bound_bytes(gl, target);
  const std::uint64_t offset = call.words[p];
  if (!needed) return wrong("is an offset into a buffer, and nobody knows how far the call goes");
  if (*needed > 0 && (offset > bytes || *needed > bytes - offset))
    return wrong(fmt::format("goes beyond the buffer: {} bytes at {} of {}", *needed, offset, bytes));
  // GL_UNPACK_COMPRESSED_BLOCK_* and similar parameters could make the driver read beyond these bytes.
  call.tight_unpack |= parameter.rule == ExtentRule::counted_or_unpack;
  call.tight_pack |= parameter.rule == ExtentRule::image_out &&
                     std::string_view(call_name(call.id)).find("Compressed") != std::string_view::npos;
  return {};
}

/// Checks a pointer that refers to memory, since no buffer is bound.
std::string Decoder::check_memory(Call& call, std::size_t p) {
  const ParameterShape& parameter = call.shape->parameters()[p];
  if (parameter.rule == ExtentRule::client_array) {
    // The elements are sent with the draws.
    call.words[p] = 0;
    return {};
  }
  if (call.kinds[p] == ReferenceKind::address)
    return in_call(call.id, fmt::format("{} is an offset, but no buffer is bound", parameter.name()));
  if (call.kinds[p] != ReferenceKind::null || !parameter.input) return {};
  if (parameter.null_with != no_argument && call.words[parameter.null_with] == 0) return {};
  const auto needed = parameter.rule == ExtentRule::image
                          ? image_extent(image_shape(call.id, call.words.data()), tight_pixels)
                          : pointee_bytes(call.id, p, call.words.data());
  if (needed ? *needed == 0 : driver_refuses(call.id, p, call.words.data())) return {};
  if (parameter.rule == ExtentRule::indirect && needed && *needed <= most_output_bytes) {
    // Core profiles report an error, others draw nothing.
    call.words[p] = reinterpret_cast<std::uintptr_t>(scratch(*needed));
    return {};
  }
  return in_call(call.id, fmt::format("{} is a null pointer", parameter.name()));
}

std::string Decoder::check_pointer(Call& call, std::size_t p, const DispatchTable& gl) {
  const auto point = buffer_point(call.shape->parameters()[p].rule);
  if (!point) return {};
  const auto bound = asked(gl, point->binding);
  if (!bound) {
    call.skip = true;
    return {};
  }
  return *bound != 0 ? check_offset(call, p, point->target, gl) : check_memory(call, p);
}

std::string Decoder::check_pointers(Call& call, const DispatchTable& gl) {
  if (call.id == CallId::BindBuffer && GLenum(call.words[0]) == GL_QUERY_BUFFER) query_buffer_ = true;
  if (query_buffer_ && std::string_view(call_name(call.id)).starts_with("glGetQueryObject"))
    return in_call(call.id, "answers into a buffer object are not sent");
  for (std::size_t p = 0; p < call.shape->parameter_count && !call.skip; ++p) {
    if (call.shape->parameters()[p].pointer == 0) continue;
    if (std::string error = check_pointer(call, p, gl); !error.empty()) return error;
  }
  return {};
}

}  // namespace understudy::spu
