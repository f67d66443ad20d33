// SPDX-License-Identifier: Apache-2.0
// Opaque geometry between the faces of a ray caster's box. The depth test hides or shows a ray whole, by the
// face that makes its fragment; nodes end it where the geometry stands, as programs do that sample its depth.
// Before and behind the box both are the same.
#pragma once

#include "spu/volume/proxy/box.h"

namespace understudy::volume {
struct RenderRequest;
}

namespace understudy::spu {

/// Whether the request's depth has, on any of `rays`, opaque geometry between where the ray enters the box and
/// where it leaves it. The rays are those of `texture_to_clip`.
bool geometry_inside(const volume::RenderRequest& request, const volume::Matrix4& texture_to_clip,
                     const RaysThroughBox& rays);

}  // namespace understudy::spu
