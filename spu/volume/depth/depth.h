// SPDX-License-Identifier: Apache-2.0
// The depth of opaque geometry before, inside or behind the volume, for the render nodes.
#pragma once

#include <optional>

#include "spu/volume/pipeline/target.h"
#include "volume/depth_image.h"

namespace understudy::spu {

struct GlContext;

/// Reads the window depth of `rect` from the framebuffer bound for drawing, `target`. Null if `rect` is empty,
/// or if a multisampled framebuffer object has no depth. Of a multisampled pixel, the depth of one sample is
/// read: at the edges of opaque geometry the others may differ.
std::optional<volume::DepthImage> read_depth(const GlContext& context, const Target& target,
                                             const volume::Rect& rect, bool or_equal);

/// Returns whether all depths are at the far end.
bool hides_nothing(const volume::DepthImage& image);

}  // namespace understudy::spu
