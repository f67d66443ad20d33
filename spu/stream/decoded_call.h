// SPDX-License-Identifier: Apache-2.0
// A record's call while the decoder is at it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "dispatch/call_shape.h"
#include "spu/stream/decode.h"
#include "spu/stream/record.h"

namespace understudy::spu {

/// Answers of a stream from elsewhere are given no more memory than this: a length there is only a claim.
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
constexpr std::size_t most_output_bytes = std::size_t(1) << 20;  // zeros would be most of an input's time
#else
constexpr std::size_t most_output_bytes = std::size_t(64) << 20;
#endif
/// Answers to the sender of a linked stream: images and buffers of applications may be large.
constexpr std::size_t most_linked_output_bytes = 16 * most_output_bytes;
/// What fills memory before OpenGL writes answers into it, so that what it wrote is seen.
constexpr std::byte unwritten{0xa5};

struct Decoder::Call {
  CallId id{};
  const CallShape* shape = nullptr;
  std::array<std::uint64_t, max_parameters> words{};
  std::array<ReferenceKind, max_parameters> kinds{};
  std::array<std::size_t, max_parameters> bytes{};  ///< there are behind a pointer
  bool skip = false;          ///< has no meaning here: an address of another process, a question
  bool into_buffer = false;   ///< what it writes goes to a bound buffer object
  bool tight_unpack = false;  ///< what it reads lies as images lie in streams, whatever GL_UNPACK_* says
  bool tight_pack = false;    ///< the same of what it writes, and GL_PACK_*
};

/// "glClear: " and what is wrong with it.
std::string in_call(CallId call, std::string_view what);

}  // namespace understudy::spu
