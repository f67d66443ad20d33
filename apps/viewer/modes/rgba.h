// SPDX-License-Identifier: Apache-2.0
// Pre-classified RGBA8 texture, fixed function, one immediate-mode triangle fan per slice. Keeps the texels,
// because a new transfer function changes the colour of every voxel.
#pragma once

#include <memory>
#include <string>

#include "apps/viewer/modes/mode.h"

namespace viewer {

std::unique_ptr<Mode> make_rgba_mode(Texels texels, const std::string& file);

}  // namespace viewer
