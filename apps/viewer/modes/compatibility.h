// SPDX-License-Identifier: Apache-2.0
// What the two compatibility-profile modes share: matrix stacks and opaque geometry in immediate mode.
#pragma once

#include "apps/viewer/model/camera.h"
#include "apps/viewer/model/opaque_geometry.h"

namespace viewer {

void load_matrices(const Matrices& matrices);

/// Fixed function, without textures or program; loads the matrices itself.
void draw_opaque_immediate(const OpaqueGeometry& geometry, const Matrices& matrices);

}  // namespace viewer
