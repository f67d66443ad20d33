// SPDX-License-Identifier: Apache-2.0
// How long the edges of texture space are in the application's world, which its camera shows: the metric in
// which ray casters take steps of one length through texels that are no cubes.
#pragma once

#include <optional>

#include "volume/texture_space.h"

namespace understudy::spu {

/// Relative to each other, the longest being 1. The camera has square pixels in a viewport of `width` x
/// `height` and looks through its middle, in perspective or parallel; the edges are at right angles. Null where
/// that is not so, and where the view is along an axis of the texture, which does not show how long it is.
std::optional<volume::Vec3> axis_lengths(const volume::Matrix4& texture_to_clip, int width, int height);

}  // namespace understudy::spu
