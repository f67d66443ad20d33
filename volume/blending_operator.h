// SPDX-License-Identifier: Apache-2.0
// How the samples of a ray are combined into the colour of its pixel.
#pragma once

#include <cstdint>

namespace understudy::volume {

/// How the samples of a ray are combined into a pixel. first_hit: the first sample with opacity above 0,
/// opaque, in its plain colour (premultiplied colour over opacity, clamped to the range of a float); such
/// images are composited by `over`, front to back.
enum class Operator : std::uint8_t { over, max, min, add, first_hit };

}  // namespace understudy::volume
