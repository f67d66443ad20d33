// SPDX-License-Identifier: Apache-2.0
// How the samples of a ray become the colour of its pixel.
#pragma once

#include <cstdint>

namespace understudy::volume {

/// How a ray's samples become a pixel. First-hit: the first sample whose opacity is above 0 alone, opaque, in
/// its plain colour (premultiplied colour over opacity, kept within what a float holds); images of it are
/// composed by `over`, front to back.
enum class Operator : std::uint8_t { over, max, min, add, first_hit };

}  // namespace understudy::volume
