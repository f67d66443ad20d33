// SPDX-License-Identifier: Apache-2.0
// Properties of the framebuffer that slices are drawn into, as far as they affect the result of blending.
#pragma once

#include "dispatch/table.h"

namespace understudy::spu {

struct Target {
  GLint alpha_bits = 0;    ///< 0: no alpha, or no colour buffer at all
  bool normalised = true;  ///< unsigned normalised components: fragments are clamped to [0,1]
  bool floating = false;
  GLint samples = 0;  ///< per pixel; 0: not multisampled
};

/// Describes the first draw buffer of the framebuffer bound for drawing.
Target read_target(const DispatchTable& gl);

}  // namespace understudy::spu
