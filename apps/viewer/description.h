// SPDX-License-Identifier: Apache-2.0
// Describes a frame so that its image can be recomputed by another program in double precision.
//
// Pixels: window coordinates of `viewport`, pixel (0, 0) at the lower left, its centre at (0.5, 0.5).
// Matrices: 16 floats, column-major, exactly as passed to OpenGL. For each of `volumes` and each slice
// in the given order: if the line through the pixel's centre meets the plane dot(normal_texture, t) =
// offset inside [0,1]^3, sample the volume at t (linear between voxel centres at (i + 0.5) / size,
// clamped to the edge), take its colour from the volume's entries (see `classification`), and blend it
// by `blend`. The first slice is blended onto the background and the triangles of `solid` (three
// positions in object space and one colour each), which hide what is not nearer; with slices front to
// back, the first slice is blended onto transparent black, and solid and background come last. The lines
// of the box's frame are not described.
#pragma once

#include <string>

#include "apps/viewer/options.h"
#include "apps/viewer/scene.h"

namespace viewer {

/// Throws Error (bad_file) if the file cannot be written.
void write_description(const std::string& path, const Options& options, const Scene& scene,
                       const DrawnFrame& frame, int frame_index);

}  // namespace viewer
