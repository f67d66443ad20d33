// SPDX-License-Identifier: Apache-2.0
// The call of a record while it is being decoded.
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

/// Limit for the memory of answers in a stream from elsewhere, whose lengths cannot be trusted.
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
constexpr std::size_t most_output_bytes = std::size_t(1) << 20;  // zeroing more would dominate the time
#else
constexpr std::size_t most_output_bytes = std::size_t(64) << 20;
#endif
/// Limit for answers to the sender of a linked stream: images and buffers of applications may be large.
constexpr std::size_t most_linked_output_bytes = 16 * most_output_bytes;
/// Fills memory before OpenGL writes answers into it, to detect what was written.
constexpr std::byte unwritten{0xa5};

struct Decoder::Call {
  CallId id{};
  const CallShape* shape = nullptr;
  std::array<std::uint64_t, max_parameters> words{};
  std::array<ReferenceKind, max_parameters> kinds{};
  std::array<std::size_t, max_parameters> bytes{};  ///< size of the memory behind a pointer
  bool skip = false;          ///< has no meaning here: an address of another process, or a query
  bool into_buffer = false;   ///< output goes to a bound buffer object
  bool tight_unpack = false;  ///< input has the layout of images in streams, whatever GL_UNPACK_* is
  bool tight_pack = false;    ///< the same for output, and GL_PACK_*
};

/// "glClear: " followed by the error `what`.
std::string in_call(CallId call, std::string_view what);

}  // namespace understudy::spu
