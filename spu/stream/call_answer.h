// SPDX-License-Identifier: Apache-2.0
// What a call has answered, on its way back to a sender that waits for it: the result, and everything that the
// call wrote through its pointers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "spu/stream/pixels.h"

namespace understudy::spu {

/// Memory that a call wrote.
struct AnsweredOutput {
  /// What no parameter points at.
  static constexpr std::uint32_t result_text = 0x100;  ///< the string that the call returned, with its zero
  static constexpr std::uint32_t mapped = 0x101;       ///< what is in the memory that a buffer was mapped to
  static constexpr std::uint32_t feedback = 0x102;     ///< what glFeedbackBuffer or glSelectBuffer was given

  std::uint32_t parameter = 0;      ///< position among the call's parameters, or one of the above
  std::optional<ImageShape> image;  ///< bytes are pixels as images lie in streams
  std::vector<std::byte> bytes;
};

struct CallAnswer {
  std::uint64_t result = 0;
  std::vector<AnsweredOutput> outputs;
};

/// Bytes of an answer: {result, number of outputs}, then for each {parameter, has an image, its width, height,
/// depth, format, type, dimensions, bytes, data up to a full word}.
std::vector<std::byte> encode(const CallAnswer& answer);
/// Nothing when the bytes are no answer.
std::optional<CallAnswer> decode_answer(std::span<const std::byte> bytes);

}  // namespace understudy::spu
