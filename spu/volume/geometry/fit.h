// SPDX-License-Identifier: Apache-2.0
// The camera of a run of slices, by linear least squares: clip = A (t, 1).
//
// Whatever matrices, texgen planes and shader arithmetic are involved, a volume drawn by slices has one
// projective map from texture space to clip space. Four affinely independent vertices determine it, the others
// confirm it: a small residual proves that the draw is a volume.
#pragma once

#include <optional>

#include "spu/volume/geometry/polygon.h"
#include "volume/texture_space.h"

namespace understudy::spu {

struct CameraFit {
  volume::Matrix4 texture_to_clip{};
  /// Largest deviation of a vertex from the fit, relative to the extent of the clip positions.
  double residual = 0;
};

/// With a larger residual, the draw is not treated as a volume. Feedback returns window coordinates in single
/// precision (about 1e-7 relative); PyMOL's own stream fits to 5e-7.
constexpr double max_fit_residual = 1e-4;

/// Returns null if the vertices do not span texture space (a single slice, a box face, fewer than four points)
/// or are not finite. The caller compares `residual` with max_fit_residual.
std::optional<CameraFit> fit_camera(std::span<const ObservedVertex> vertices);

}  // namespace understudy::spu
