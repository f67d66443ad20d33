// SPDX-License-Identifier: Apache-2.0
// The part of a viewport in which a program keeps its fragments.
//
// vispy clips every view to its place in the window with gl_FragCoord and `discard`; at some sizes of the
// window this removes a row of pixels at its edge. The application's own box, drawn so large that every pixel
// of the viewport has a ray through it, shows which pixels are kept, wherever the box is seen.
#pragma once

#include <variant>
#include <vector>

#include "spu/volume/proxy/coordinate_space.h"
#include "spu/volume/refusal/refusal.h"
#include "volume/image.h"

namespace understudy::spu {

struct KeptWindow {
  volume::Rect viewport;       ///< in which it was measured
  std::vector<float> depends;  ///< what the discards depend on (march_inputs.h)
  volume::Rect kept;           ///< in pixels of the window
};

/// Measures the kept part row by row and column by column. Refused if it is not a rectangle, or if `box` is
/// seen so small that it cannot be drawn over the whole viewport.
std::variant<volume::Rect, Refusal> kept_rect(const MarchContext& measured, const ProxyBox& box);

}  // namespace understudy::spu
