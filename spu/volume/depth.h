// The opaque geometry that stands before, inside or behind the volume: its depth, for the render nodes.
#pragma once

#include <optional>

#include "spu/volume/context.h"
#include "volume/request.h"

namespace understudy::spu {

/// Window depth of `rect` of the framebuffer bound for drawing. Empty where nothing was drawn before the volume
/// (all depths are at the far end), so that a scene without opaque geometry sends no depth.
std::optional<volume::DepthImage> read_depth(const GlContext& context, const volume::Rect& rect, bool or_equal);

}  // namespace understudy::spu
