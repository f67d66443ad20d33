// SPDX-License-Identifier: Apache-2.0
// Observing fixed-function vertices: the run's vertices are drawn once in feedback mode, where OpenGL writes
// down what reaches the rasteriser instead of rasterising it. Matrices, texgen as it was set, texture matrix,
// display lists, user clip planes and lighting are all the driver's own answer; nothing is emulated. 500 quads
// cost about 0.4 ms.
#pragma once

#include "spu/volume/context/context.h"
#include "spu/volume/geometry/given_vertices.h"
#include "spu/volume/geometry/polygon.h"
#include "spu/volume/observation/run.h"

namespace understudy::spu {

struct GlContext;

/// Compatibility contexts only; the volume must be on texture unit 0, the only one that feedback tells about.
/// The third coordinate of a stack's slices is their number. Empty polygons when nothing is visible or the
/// buffer would exceed 256 MiB.
ObservedPolygons observe_by_feedback(const GlContext& context, const Run& run, GivenVertices& given);

}  // namespace understudy::spu
