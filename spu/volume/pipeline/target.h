// SPDX-License-Identifier: Apache-2.0
// The framebuffer that slices are drawn into, as far as it changes what blending leaves there.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

struct Target {
  GLint alpha_bits = 0;    ///< 0: no alpha, or no colour buffer at all
  bool normalised = true;  ///< unsigned normalised components: fragments are clamped to [0,1]
  bool floating = false;
  GLint samples = 0;  ///< of each pixel; 0: not multisampled
};

/// Describes the first draw buffer of the framebuffer bound for drawing.
Target read_target(const DispatchTable& gl);

}  // namespace understudy::spu
