// SPDX-License-Identifier: Apache-2.0
// How long the edges of texture space are in the application's world, derived from its camera: the metric in
// which ray casters take steps of equal length through texels that are not cubes.
#pragma once

#include <optional>

#include "volume/texture_space.h"

namespace understudy::spu {

/// Returns the lengths relative to the longest, which is 1. Assumes square pixels in a viewport of `width` x
/// `height`, a camera that looks through its middle, in perspective or parallel, and edges at right angles.
/// Null if these do not hold, or if the view is along an axis of the texture and does not show its length.
std::optional<volume::Vec3> axis_lengths(const volume::Matrix4& texture_to_clip, int width, int height);

}  // namespace understudy::spu
