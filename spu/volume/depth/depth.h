// SPDX-License-Identifier: Apache-2.0
// The opaque geometry that stands before, inside or behind the volume: its depth, for the render nodes.
#pragma once

#include <optional>

#include "spu/volume/pipeline/target.h"
#include "volume/depth_image.h"

namespace understudy::spu {

struct GlContext;

/// Window depth of `rect` of the framebuffer bound for drawing, `target`. Nothing where it has none. Of a
/// multisampled framebuffer one sample's depth stands for the pixel: along the edges of opaque geometry the
/// others may differ.
std::optional<volume::DepthImage> read_depth(const GlContext& context, const Target& target,
                                             const volume::Rect& rect, bool or_equal);

/// All of it is at the far end.
bool hides_nothing(const volume::DepthImage& image);

}  // namespace understudy::spu
