// SPDX-License-Identifier: Apache-2.0
#include "spu/stream/argument_bytes.h"

#include "dispatch/call_shape.h"
#include "spu/stream/extent.h"
#include "spu/stream/pixels.h"

namespace understudy::spu {
std::optional<std::size_t> argument_bytes(CallId call, std::size_t parameter, const std::uint64_t* words) {
  if (words[parameter] == 0) return 0;
  switch (call_shape(call).parameters()[parameter].rule) {
    case ExtentRule::image:
    case ExtentRule::image_out:
      return image_extent(image_shape(call, words), tight_pixels);
    default:
      return pointee_bytes(call, parameter, words);
  }
}

std::uint64_t call_bytes(CallId call, const std::uint64_t* words) {
  std::uint64_t bytes = 0;
  const std::span<const ParameterShape> parameters = call_shape(call).parameters();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].pointer > 0) bytes += argument_bytes(call, i, words).value_or(0);
  }
  return bytes;
}

}  // namespace understudy::spu
