// SPDX-License-Identifier: Apache-2.0
// The size of the pixels that a command is going to write.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "dispatch/call_id.h"
#include "dispatch/table.h"
#include "spu/stream/pixels.h"

namespace understudy::spu {

struct ImageAnswer {
  std::optional<ImageShape> shape;  ///< nothing: bytes without rows, independent of GL_PACK_*
  std::size_t bytes = 0;            ///< with rows that follow each other without gaps
};

/// What the command with these arguments writes; queries `gl` for the size of textures. Nothing if it writes
/// nothing, or is not supported here: separable filters, histograms and extrema.
std::optional<ImageAnswer> image_answer(CallId call, const std::uint64_t* words, const DispatchTable& gl);

}  // namespace understudy::spu
