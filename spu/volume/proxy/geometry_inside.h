// SPDX-License-Identifier: Apache-2.0
// Opaque geometry between the faces of a ray caster's box. The depth test hides or shows a whole ray, by the
// face that produces its fragment; nodes end the ray at the geometry, as programs do that sample its depth. For
// geometry in front of the box or behind it, both give the same image.
#pragma once

#include "spu/volume/proxy/box.h"

namespace understudy::volume {
struct RenderRequest;
}

namespace understudy::spu {

/// Whether the request's depth image has, on any of `rays`, opaque geometry between the ray's entry into the
/// box and its exit. The rays are those of `texture_to_clip`.
bool geometry_inside(const volume::RenderRequest& request, const volume::Matrix4& texture_to_clip,
                     const RaysThroughBox& rays);

}  // namespace understudy::spu
