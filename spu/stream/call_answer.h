// SPDX-License-Identifier: Apache-2.0
// The answer of a call, sent back to a sender that waits for it: the result, and everything that the call wrote
// through its pointers.
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
  /// Outputs that belong to no parameter.
  static constexpr std::uint32_t result_text = 0x100;  ///< the returned string, with its zero
  static constexpr std::uint32_t mapped = 0x101;       ///< the contents of a mapped buffer
  static constexpr std::uint32_t feedback = 0x102;     ///< the contents of the feedback or selection buffer

  std::uint32_t parameter = 0;      ///< position among the call's parameters, or one of the above
  std::optional<ImageShape> image;  ///< set if bytes are pixels in the layout of images in streams
  std::vector<std::byte> bytes;
};

struct CallAnswer {
  std::uint64_t result = 0;
  std::vector<AnsweredOutput> outputs;
};

/// Format of an answer: {result, number of outputs}, then for each output {parameter, has an image, its width,
/// height, depth, format, type, dimensions, bytes, data padded to a full word}.
std::vector<std::byte> encode(const CallAnswer& answer);
/// Returns nothing if the bytes are not a valid answer.
std::optional<CallAnswer> decode_answer(std::span<const std::byte> bytes);

}  // namespace understudy::spu
