// SPDX-License-Identifier: Apache-2.0
// Shared by the compatibility-profile modes: matrix stacks, and opaque geometry in immediate mode.
#pragma once

#include "apps/viewer/model/camera.h"
#include "apps/viewer/model/opaque_geometry.h"

namespace viewer {

void load_matrices(const Matrices& matrices);

/// Draws with fixed function, without textures or program; also loads the matrices.
void draw_opaque_immediate(const OpaqueGeometry& geometry, const Matrices& matrices);

}  // namespace viewer
