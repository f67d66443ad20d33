// SPDX-License-Identifier: Apache-2.0
// Blends two runs of premultiplied float RGBA pixels with one operator. The arithmetic is the framebuffer's
// (glBlendFunc, glBlendEquation), carried out in float, so any grouping of neighbours gives the same image to
// within rounding (at most 1e-6 for any tree of partial images).
#pragma once

#include <span>

#include "volume/blending_operator.h"
#include "volume/image.h"

namespace understudy::compositor {

/// Computes front = front `op` back, pixel by pixel. Both have the same number of components, a multiple of
/// four. Under `over`, and `first_hit`, every component including alpha grows by (1 - alpha) * back, so fog of
/// alpha 1e-9 still adds up. The other operators commute.
void blend(volume::Operator op, std::span<float> front, std::span<const float> back);

/// Blends the part of `back` that lies in `front.rect` behind `front`.
void blend(volume::Operator op, volume::Image& front, const volume::ImageView& back);

}  // namespace understudy::compositor
