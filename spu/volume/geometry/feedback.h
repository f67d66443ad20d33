// SPDX-License-Identifier: Apache-2.0
// Captures fixed-function vertices: draws the run once in feedback mode, in which OpenGL returns what reaches
// the rasteriser instead of rasterising it. The driver itself applies matrices, texgen as it was set, texture
// matrix, display lists, user clip planes and lighting; nothing is emulated. 500 quads cost about 0.4 ms.
#pragma once

#include "spu/volume/context/context.h"
#include "spu/volume/geometry/given_vertices.h"
#include "spu/volume/geometry/polygon.h"
#include "spu/volume/observation/run.h"

namespace understudy::spu {

struct GlContext;

/// Compatibility contexts only; the volume must be on texture unit 0, the only one that feedback reports. The
/// third coordinate of a stack's slices is their index. Returns empty polygons if nothing is visible, or if the
/// buffer would exceed 256 MiB.
ObservedPolygons observe_by_feedback(const GlContext& context, const Run& run, GivenVertices& given);

}  // namespace understudy::spu
